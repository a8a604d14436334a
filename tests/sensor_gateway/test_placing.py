"""A body of known place is put there again from what a pose model tells of it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.calibration import Calibration
from camera_bodies import K, as_seen, landmark_points, projected, standing_at
from people import reaching, turned
from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import MODEL_HEIGHT_M, PlacingError, placed, rotation_to_ray
from sensor_gateway.people.pose_estimator import MEDIAPIPE_WEIGHTS

MEASURED = Lens(K, np.zeros(5), assumed=False)
places = {"x_m": st.floats(-0.8, 0.8), "z_m": st.floats(2.0, 3.0)}


def errors_m(points_m: np.ndarray, landmarks: Landmarks, lens: Lens = MEASURED) -> float:
    return float(np.linalg.norm(placed(landmarks, lens).joints_m - MEDIAPIPE_WEIGHTS @ points_m, axis=1).max())


@given(phase=st.floats(0, 1), heading=st.floats(-1.5, 1.5), **places)
def test_joints_are_within_five_centimetres_at_two_to_three_metres(
    x_m: float, z_m: float, phase: float, heading: float
) -> None:
    body = landmark_points(turned(reaching(phase), heading))
    body += np.array([x_m, 0.1, z_m]) - body.mean(axis=0)
    assert errors_m(body, as_seen(body)) < 0.05


@given(seed=st.integers(0, 1000), **places)
def test_pixels_that_are_two_off_and_bones_that_are_two_centimetres_off_cost_little(
    x_m: float, z_m: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    body = standing_at(x_m, z_m)
    seen = as_seen(body)
    noisy = replace(
        seen,
        image_px=seen.image_px + rng.normal(0, 2, (33, 2)),
        world_m=seen.world_m + rng.normal(0, 0.02, (33, 3)),
    )
    offsets = placed(noisy, MEASURED).joints_m - MEDIAPIPE_WEIGHTS @ body
    assert np.linalg.norm(offsets.mean(axis=0)[:2]) < 0.025  # five standard deviations
    assert abs(offsets.mean(axis=0)[2]) < 0.10


def test_distortion_is_taken_into_account() -> None:
    bent = Lens(K, np.array([-0.25, 0.08, 0.001, -0.001, 0.0]), assumed=False)
    body = standing_at(0.7, 2.2)
    seen = as_seen(body)
    distorted = cv2.projectPoints(body, np.zeros(3), np.zeros(3), K, bent.distortion)[0].reshape(-1, 2)
    as_bent = replace(seen, image_px=distorted)
    assert errors_m(body, as_bent, bent) < 0.05
    assert errors_m(body, as_bent, MEASURED) > 0.05


def test_a_hidden_landmark_does_not_move_the_rest() -> None:
    body = standing_at(0.2, 2.5)
    seen = as_seen(body)
    wrong, visibility = seen.image_px.copy(), seen.visibility.copy()
    wrong[15] += 200
    visibility[15] = 0.0
    assert errors_m(body, replace(seen, image_px=wrong, visibility=visibility)) < 0.05


def test_a_smaller_person_of_unknown_size_is_placed_too_far_and_a_known_height_puts_that_right() -> None:
    body = standing_at(0.0, 2.0, size=0.9)
    of_the_models_size = as_seen(body, size=0.9)
    unknown = placed(of_the_models_size, MEASURED)
    assert (unknown.joints_m - MEDIAPIPE_WEIGHTS @ body)[:, 2].mean() == pytest.approx(0.22, abs=0.01)
    assert unknown.depth_std_m == pytest.approx(0.07 * unknown.joints_m[:, 2].mean())
    known = placed(of_the_models_size, MEASURED, person_height_m=0.9 * MODEL_HEIGHT_M)
    assert np.linalg.norm(known.joints_m - MEDIAPIPE_WEIGHTS @ body, axis=1).max() < 0.05
    assert known.depth_std_m < unknown.depth_std_m / 2


def test_what_lies_behind_the_camera_has_no_place() -> None:
    seen = as_seen(standing_at(0.0, 2.0))
    upside_down = replace(seen, image_px=480 - seen.image_px)
    with pytest.raises(PlacingError):
        placed(upside_down, MEASURED)


@given(x=st.floats(-1, 1), y=st.floats(-1, 1))
def test_the_turn_is_a_rotation_of_the_axis_to_the_line_of_sight(x: float, y: float) -> None:
    rotation = rotation_to_ray(np.array([x, y]))
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1)
    assert rotation @ [0, 0, 1] == pytest.approx(np.array([x, y, 1]) / np.linalg.norm([x, y, 1]))


def test_an_assumed_lens_spans_its_field_of_view_and_says_that_it_is_assumed() -> None:
    lens = Lens.of_field_of_view(640, 480, 60.0)
    left, right = lens.rays(np.array([[-0.5, 239.5], [639.5, 239.5]]))
    assert np.degrees(np.arctan(right[0]) - np.arctan(left[0])) == pytest.approx(60.0)
    assert lens.assumed


def test_a_camera_turned_upright_has_the_same_focal_length() -> None:
    upright, lying = Lens.of_field_of_view(480, 640, 60.0), Lens.of_field_of_view(640, 480, 60.0)
    assert upright.matrix[0, 0] == lying.matrix[0, 0]
    top, bottom = upright.rays(np.array([[239.5, -0.5], [239.5, 639.5]]))
    assert np.degrees(np.arctan(bottom[1]) - np.arctan(top[1])) == pytest.approx(60.0)


def test_a_calibrations_lens_sees_along_the_lines_that_were_measured() -> None:
    calibration = Calibration(image_size=(640, 480), K=K.ravel().tolist(), distortion=[0.1, 0, 0, 0, 0])
    lens = Lens.of_calibration(calibration)
    assert not lens.assumed
    assert lens.rays(projected(np.array([[0.0, 0.0, 1.0]])))[0] == pytest.approx([0, 0])


def test_a_pose_model_without_metres_places_a_person_who_faces_the_camera() -> None:
    body = standing_at(0.3, 2.4)
    found = placed(replace(as_seen(body), world_m=None), MEASURED)
    apart = np.linalg.norm(found.joints_m - MEDIAPIPE_WEIGHTS @ body, axis=1)
    assert np.median(apart) < 0.1


def test_a_person_whose_trunk_is_a_single_point_of_the_image_has_no_place() -> None:
    seen = as_seen(standing_at(0.0, 2.0))
    with pytest.raises(PlacingError):
        placed(replace(seen, world_m=None, image_px=np.full((33, 2), 200.0)), MEASURED)
