"""Objects that carry several markers, of one family or of several, are one object each."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings

BOX = """
family: 4X4_50
size_m: 0.08
objects:
  9:
    name: box
    markers:
      - {id: 1, object_from_marker: {translation_m: [-0.06, 0, 0.05]}}
      - {id: 2, object_from_marker: {translation_m: [0.06, 0, 0.05]}}
"""


@pytest.fixture
def tracker(tmp_path: Path) -> MarkerTracker:
    (tmp_path / "objects.yaml").write_text(BOX)
    return MarkerTracker(Settings(scene=tmp_path / "objects.yaml"))


def markers_of(box: Any, *numbers: int) -> list[tuple[int, float, Any]]:
    """The box's markers where a box at a pose, image_from_object, has them."""
    offset = {1: [-0.06, 0, 0.05], 2: [0.06, 0, 0.05]}
    placed = []
    for number in numbers:
        object_from_marker = np.eye(4)
        object_from_marker[:3, 3] = offset[number]
        placed.append((number, 0.08, box @ object_from_marker))
    return placed


@pytest.mark.parametrize("numbers", [(1,), (2,), (1, 2)])
def test_the_objects_centre_is_found_from_any_of_its_markers(tracker, image_of, pose_at, numbers) -> None:
    box = pose_at((0.05, 0.1, 0.9), (0.3, 0.5, 0.1))
    (answer,) = tracker.handle(image_of(markers_of(box, *numbers)))
    (found,) = answer.objects
    assert (found.id, found.name) == (9, "box")
    assert np.linalg.norm(np.subtract(found.position_m, box[:3, 3])) < 0.008


def test_two_markers_fix_the_pose_better_than_one(image_of, pose_at, tmp_path) -> None:
    (tmp_path / "objects.yaml").write_text(BOX)
    box = pose_at((0.2, 0.1, 1.6), (0.1, 0.15, 0.0))

    def off_m(*numbers: int) -> float:
        (answer,) = MarkerTracker(Settings(scene=tmp_path / "objects.yaml")).handle(image_of(markers_of(box, *numbers)))
        return float(np.linalg.norm(np.subtract(answer.objects[0].position_m, box[:3, 3])))

    assert off_m(1, 2) < max(off_m(1), off_m(2))


def test_markers_that_are_not_where_the_scene_puts_them_are_counted(tracker, image_of, pose_at) -> None:
    apart = [(1, 0.08, pose_at((-0.2, 0.0, 0.9))), (2, 0.08, pose_at((0.2, 0.0, 0.9)))]
    (answer,) = tracker.handle(image_of(apart))
    assert [found.id for found in answer.objects] == [9]
    assert tracker.counters.rejects == {"markers_disagree": 1}


def test_only_families_of_the_scene_are_searched(tracker, image_of, pose_at) -> None:
    other = image_of([(1, 0.08, pose_at((0.0, 0.0, 0.8)))], dictionary="DICT_APRILTAG_16H5")
    (answer,) = tracker.handle(other)
    assert answer.objects == []


def test_the_same_number_in_two_families_is_two_objects(tmp_path, image_of, pose_at) -> None:
    (tmp_path / "s.yaml").write_text(
        "size_m: 0.12\nobjects:\n  1: {name: cup, family: 4X4_50, markers: [{id: 3}]}\n"
        "  2: {name: box, family: APRILTAG_16h5, markers: [{id: 3}]}\n"
    )
    tracker = MarkerTracker(Settings(scene=tmp_path / "s.yaml"))
    left = image_of([(3, 0.12, pose_at((-0.2, 0.0, 0.9)))])
    right = image_of([(3, 0.12, pose_at((0.2, 0.0, 0.9)))], dictionary="DICT_APRILTAG_16H5")
    pixels = [np.frombuffer(each.data, np.uint8).reshape(480, 640, 3) for each in (left, right)]
    both = left.model_copy(update={"data": cv2.hconcat([pixels[0][:, :320], pixels[1][:, 320:]]).tobytes()})
    (answer,) = tracker.handle(both)
    assert [(found.id, found.name) for found in answer.objects] == [(1, "cup"), (2, "box")]
    assert np.allclose([found.position_m[0] for found in answer.objects], [-0.2, 0.2], atol=0.01)
