"""Markers rendered from known poses are found where they are."""

from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.geometry import quaternion_xyzw
from actum.messages import Image, Objects
from actum.node import SECOND_NS
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import ObjectSpec, Settings
from rotation_of import rotation_of

POSES = [
    ((0.0, 0.0, 0.8), (0.0, 0.0, 0.0)),
    ((0.3, -0.2, 1.2), (0.5, 0.0, 0.2)),
    ((-0.35, 0.25, 1.2), (0.0, -0.6, 2.0)),
    ((0.2, 0.3, 1.0), (0.7, 0.3, -1.0)),
]


def track(image: Image, **settings: Any) -> Objects:
    (answer,) = MarkerTracker(Settings(**settings)).handle(image)
    assert isinstance(answer, Objects)
    return answer


@pytest.mark.parametrize("image_format", ["bgr8", "jpeg"])
@pytest.mark.parametrize(("position_m", "tilt"), POSES)
def test_a_marker_is_where_it_was_rendered(image_of, pose_at, position_m, tilt, image_format) -> None:
    answer = track(image_of([(3, 0.12, pose_at(position_m, tilt))], image_format=image_format), marker_size_m=0.12)
    (found,) = answer.objects
    error_m = np.linalg.norm(np.subtract(found.position_m, position_m))
    assert (found.id, found.seen, answer.valid) == (3, True, True)
    assert error_m < 0.01 * np.linalg.norm(position_m)


@pytest.mark.parametrize("distance_m", [1.5, 1.8, 2.1])
def test_a_marker_of_twenty_pixels_is_within_three_percent(image_of, pose_at, distance_m) -> None:
    position_m = [0.3, 0.2, distance_m]
    (found,) = track(image_of([(3, 0.08, pose_at(position_m, (0.3, 0.2, 0.1)))])).objects
    assert np.linalg.norm(np.subtract(found.position_m, position_m)) < 0.03 * np.linalg.norm(position_m)


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.5, 0.0, 0.2), (0.0, -0.6, 2.0), (0.7, 0.3, -1.0)])
@pytest.mark.parametrize("distance_m", [0.7, 0.8])
def test_orientation_is_the_rendered_one(image_of, pose_at, tilt, distance_m) -> None:
    image_from_marker = pose_at((0.0, 0.0, distance_m), tilt)
    (found,) = track(image_of([(5, 0.12, image_from_marker)]), marker_size_m=0.12).objects
    apart = cv2.Rodrigues(rotation_of(found.quaternion_xyzw) @ image_from_marker[:3, :3].T)[0]
    assert np.degrees(np.linalg.norm(apart)) < 3.0


@given(st.tuples(*[st.floats(-1, 1)] * 3), st.one_of(st.floats(0, np.pi), st.floats(np.pi - 1e-4, np.pi)))
def test_a_quaternion_is_the_rotation_it_was_made_from(axis, angle) -> None:
    unit = np.array(axis) / np.linalg.norm(axis) if np.linalg.norm(axis) > 1e-3 else np.array([0.0, 0.0, 1.0])
    rotation = cv2.Rodrigues(unit * angle)[0]
    assert np.allclose(rotation_of(quaternion_xyzw(rotation)), rotation, atol=1e-6)


def test_positions_are_in_the_skeletons_camera_frame(image_of, pose_at) -> None:
    skeleton_from_image = np.eye(4)
    skeleton_from_image[:3, :3] = cv2.Rodrigues(np.array([0.0, np.pi / 2, 0.0]))[0]
    skeleton_from_image[:3, 3] = [0.1, 0.2, 0.3]
    image = image_of([(3, 0.12, pose_at((0.2, -0.1, 0.9)))], skeleton_from_image=skeleton_from_image.ravel().tolist())
    (found,) = track(image, marker_size_m=0.12).objects
    # A quarter turn about y takes the image's z to the skeleton's x, and its x to -z.
    assert np.allclose(found.position_m, [0.9 + 0.1, -0.1 + 0.2, -0.2 + 0.3], atol=0.01)


def test_each_object_has_its_own_name_and_size(image_of, pose_at) -> None:
    markers = [(1, 0.08, pose_at((-0.2, 0.0, 0.8))), (2, 0.12, pose_at((0.2, 0.0, 1.0)))]
    objects = {1: ObjectSpec(name="cup"), 2: ObjectSpec(name="box", size_m=0.12)}
    cup, box = track(image_of(markers), objects=objects, marker_size_m=0.08).objects
    assert (cup.name, box.name) == ("cup", "box")
    assert np.allclose(cup.position_m, [-0.2, 0.0, 0.8], atol=0.01)
    assert np.allclose(box.position_m, [0.2, 0.0, 1.0], atol=0.01)


def test_a_marker_on_none_of_the_objects_is_counted_and_left_out(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(objects={1: ObjectSpec(name="cup")}))
    (answer,) = tracker.handle(image_of([(7, 0.12, pose_at((0.0, 0.0, 0.8)))]))
    assert answer.objects == []
    assert tracker.counters.rejects == {"unknown_marker": 1}


def test_the_same_marker_twice_is_one_object_and_counted(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=0.12))
    twice = [(3, 0.12, pose_at((-0.2, 0.0, 0.8))), (3, 0.12, pose_at((0.2, 0.0, 0.8), (0.0, 0.7, 0.0)))]
    (answer,) = tracker.handle(image_of(twice))
    assert [found.id for found in answer.objects] == [3]
    assert tracker.counters.rejects == {"repeated_marker": 1}


def test_of_a_marker_seen_twice_the_one_that_was_followed_is(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=0.12))
    places = []
    for frame, (left_z, right_z) in enumerate([(0.8, 0.82), (0.82, 0.8), (0.82, 0.8), (0.82, 0.8)]):
        twice = [(3, 0.12, pose_at((-0.2, 0.0, left_z))), (3, 0.12, pose_at((0.2, 0.0, right_z)))]
        (answer,) = tracker.handle(image_of(twice, stamp_ns=frame * SECOND_NS // 15))
        places.append(answer.objects[0].position_m[0])
    assert np.allclose(places, -0.2, atol=0.01)
    assert tracker.counters.rejects == {"repeated_marker": 4}


def test_another_dictionary_is_chosen_by_name(image_of, pose_at) -> None:
    image = image_of([(3, 0.12, pose_at((0.0, 0.0, 0.8)))], dictionary="DICT_APRILTAG_16H5")
    assert track(image).objects == []
    assert [found.id for found in track(image, dictionary="DICT_APRILTAG_16H5").objects] == [3]


def test_an_unknown_dictionary_is_named() -> None:
    with pytest.raises(ValueError, match="'DICT_9X9' is not a marker dictionary"):
        Settings(dictionary="DICT_9X9")


def test_confidence_falls_with_a_markers_size_in_the_image(image_of, pose_at) -> None:
    near, far = (track(image_of([(3, 0.08, pose_at((0.0, 0.0, z)))])).objects[0].confidence for z in (0.8, 2.2))
    assert 0.0 < far < near <= 1.0


def test_objects_settings_come_from_the_environment(monkeypatch) -> None:
    monkeypatch.setenv("ACTUM_OBJECTS", '{"3": {"name": "cup", "size_m": 0.06}}')
    assert Settings().objects == {3: ObjectSpec(name="cup", size_m=0.06)}
