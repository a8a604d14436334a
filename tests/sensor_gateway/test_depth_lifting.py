"""Joints lifted by depth, against bodies of known geometry."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from actum.skeletons import INDEX, JOINTS
from rendered_bodies import Person, depth_of, landmarks_of, person
from sensor_gateway.lens import Lens
from sensor_gateway.people.depth_lifting import lifted
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import Placed, placed

WIDTH, HEIGHT = 640, 480
LENS = Lens(np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]), np.zeros(5), assumed=False)

ARM_ASIDE = {
    "right_elbow": (-0.46, -0.46, 0.0),
    "right_wrist": (-0.70, -0.46, 0.0),
    "right_pinky": (-0.79, -0.44, 0.0),
    "right_index": (-0.79, -0.46, 0.0),
}
HAND_ON_CHEST = {
    "right_elbow": (-0.26, -0.22, -0.05),
    "right_wrist": (-0.08, -0.20, -0.20),
    "right_pinky": (0.0, -0.18, -0.22),
    "right_index": (0.0, -0.20, -0.22),
}


def depth(body: Person, wall_m: float = 4.0) -> NDArray[np.float32]:
    return depth_of(body, LENS, WIDTH, HEIGHT, wall_m)


def missed_cm(body: Person, found: Placed) -> dict[str, float]:
    apart = np.linalg.norm(found.joints_m - body.joints_m, axis=1)
    return dict(zip(JOINTS, 100 * apart, strict=True))


def worst_cm(body: Person, found: Placed) -> float:
    return max(missed_cm(body, found).values())


@pytest.mark.parametrize(
    "body",
    [
        person(),
        person(at_m=(0.0, -0.1, 1.9)),
        person(at_m=(0.5, 0.1, 3.4)),
        person(turn_deg=20),
        person(turn_deg=-20),
        person(size=1.12),
        person(size=0.9),
        person(**ARM_ASIDE),
        person(**HAND_ON_CHEST),
    ],
    ids=["plain", "near", "far and aside", "turned", "turned back", "tall", "short", "arm aside", "hand on chest"],
)
def test_every_joint_is_within_two_centimetres_whatever_size_the_model_takes_for_granted(body: Person) -> None:
    marks = landmarks_of(body, LENS, model_size=body.thicker)

    assert worst_cm(body, lifted(marks, LENS, depth(body))) < 2.0


def test_colour_alone_is_twenty_centimetres_off_where_the_model_takes_the_person_for_a_tenth_larger() -> None:
    body = person()
    marks = landmarks_of(body, LENS, model_size=1 / 1.1)

    assert worst_cm(body, placed(marks, LENS)) > 20
    assert worst_cm(body, lifted(marks, LENS, depth(body))) < 2.2


def test_somebody_nearer_than_a_metre_is_lifted_as_well() -> None:
    body = person(at_m=(0.0, -0.1, 0.95))
    marks = landmarks_of(body, LENS, model_size=1 / 1.1)

    assert worst_cm(body, placed(marks, LENS)) > 5
    assert worst_cm(body, lifted(marks, LENS, depth(body))) < 2.2


@settings(max_examples=10)
@given(seed=st.integers(0, 1000))
def test_what_the_model_has_wrong_in_relative_distance_does_not_matter(seed: int) -> None:
    """As long as it is less than a joint's reach."""
    body = person()
    wrong_m = np.random.default_rng(seed).normal(0, 0.04, 33).clip(-0.08, 0.08)
    marks = landmarks_of(body, LENS, wrong_m=wrong_m)

    assert worst_cm(body, lifted(marks, LENS, PLAIN)) < 2.0


def test_people_thicker_or_thinner_than_the_table_are_missed_by_little_more_than_that() -> None:
    for thicker in (0.85, 1.15):
        body = person(thicker=thicker)
        assert worst_cm(body, lifted(landmarks_of(body, LENS), LENS, depth(body))) < 3.0


def test_scattered_holes_and_noise_change_little() -> None:
    rng = np.random.default_rng(1)
    body = person()
    holes = np.where(rng.random(PLAIN.shape) < 0.4, 0, PLAIN + rng.normal(0, 0.008, PLAIN.shape)).astype(np.float32)

    assert worst_cm(body, lifted(landmarks_of(body, LENS), LENS, holes)) < 2.5


def test_missing_depth_may_be_nan_as_well_as_zero() -> None:
    body = person()
    holes = np.random.default_rng(1).random(PLAIN.shape) < 0.3
    marks = landmarks_of(body, LENS)

    zeros = lifted(marks, LENS, np.where(holes, 0, PLAIN).astype(np.float32))
    nans = lifted(marks, LENS, np.where(holes, np.nan, PLAIN).astype(np.float32))
    np.testing.assert_array_equal(zeros.joints_m, nans.joints_m)


def test_a_joint_in_a_hole_keeps_its_place_on_the_body_with_half_the_confidence() -> None:
    body = person(**ARM_ASIDE)
    marks = landmarks_of(body, LENS, model_size=1.1)
    whole = depth(body)
    x, y = np.rint(marks.joints(marks.image_px)[INDEX["right_hand"]]).astype(int)
    holed = whole.copy()
    holed[y - 25 : y + 25, x - 35 : x + 35] = 0

    found, unharmed = lifted(marks, LENS, holed), lifted(marks, LENS, whole)

    assert missed_cm(body, found)["right_hand"] < 2.0
    hand = INDEX["right_hand"]
    assert found.confidence[hand] == pytest.approx(unharmed.confidence[hand] / 2)
    others = [i for i in range(15) if i != hand]
    np.testing.assert_array_equal(found.confidence[others], unharmed.confidence[others])


def test_a_thin_arm_is_not_taken_for_the_wall_close_behind_it() -> None:
    body = person(**ARM_ASIDE)
    wall = depth(body, wall_m=2.7)

    for off_px in ((0.0, 0.0), (0.0, 5.0), (0.0, -5.0)):
        found = lifted(landmarks_of(body, LENS, off_px=np.array(off_px)), LENS, wall)
        assert abs(100 * (found.joints_m[INDEX["right_hand"], 2] - 2.5)) < 2.5
        assert abs(100 * (found.joints_m[INDEX["right_elbow"], 2] - 2.5)) < 2.5


def test_values_mixed_at_edges_are_left_out() -> None:
    body = person(**ARM_ASIDE)
    mixed = cv2.blur(depth(body), (7, 7))

    assert worst_cm(body, lifted(landmarks_of(body, LENS), LENS, mixed.astype(np.float32))) < 2.5


def test_a_hidden_joint_is_not_given_the_surface_that_hides_it() -> None:
    body = person()
    marks = landmarks_of(body, LENS, model_size=1.1, hidden=("left_hip", "left_knee", "left_ankle", "left_foot_index"))
    before = PLAIN.copy()
    before[240:, 320:] = 1.2

    found = lifted(marks, LENS, before)

    missed = missed_cm(body, found)
    assert max(missed[name] for name in ("left_hip", "left_knee", "left_foot")) < 4.0
    assert found.confidence[INDEX["left_knee"]] < 0.2


def test_a_table_before_the_legs_is_not_taken_for_them_even_if_the_model_believes_to_see_them() -> None:
    body = person()
    table = PLAIN.copy()
    table[300:] = 1.5

    found = lifted(landmarks_of(body, LENS, model_size=1.1), LENS, table)

    assert worst_cm(body, found) < 4.0
    assert found.confidence[INDEX["left_knee"]] == found.confidence[INDEX["head"]] / 2


def test_without_depth_people_are_placed_as_by_colour_alone() -> None:
    marks = landmarks_of(person(), LENS)
    nothing = np.zeros((HEIGHT, WIDTH), dtype=np.float32)

    found, alone = lifted(marks, LENS, nothing, 1.8), placed(marks, LENS, 1.8)

    np.testing.assert_array_equal(found.joints_m, alone.joints_m)
    assert found.depth_std_m == alone.depth_std_m is not None


def test_somebody_half_out_of_the_image_is_lifted_by_what_is_in_it() -> None:
    body = person(at_m=(1.25, 0.1, 2.5))
    found = lifted(landmarks_of(body, LENS, model_size=1.1), LENS, depth(body))

    assert missed_cm(body, found)["right_shoulder"] < 2.0
    assert missed_cm(body, found)["left_elbow"] < 4.0


def test_joints_stay_on_their_lines_of_sight() -> None:
    marks: Landmarks = landmarks_of(person(), LENS, model_size=1.1)
    pixels = lambda found: found.joints_m[:, :2] / found.joints_m[:, 2:]  # noqa: E731 - where a joint is seen

    np.testing.assert_allclose(pixels(lifted(marks, LENS, PLAIN)), pixels(placed(marks, LENS)), atol=1e-9)


PLAIN = depth(person())


@pytest.mark.parametrize("body", [person(), person(at_m=(0.5, 0.1, 3.4)), person(size=1.12)])
def test_depth_places_the_joints_of_a_pose_model_that_gives_no_metres(body: Person) -> None:
    seen = replace(landmarks_of(body, LENS), world_m=None)
    assert worst_cm(body, lifted(seen, LENS, depth(body))) < 5
