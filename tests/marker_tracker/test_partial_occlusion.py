"""A marker that a hand covers in part is followed by what shows of it, and no marker is made up."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum.node import SECOND_NS
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings

SKIN = (130, 165, 208)
RATE_HZ = 15


def place(i: int) -> tuple[float, float, float]:
    """Lifted by 20 cm within a second."""
    share = min(i / RATE_HZ, 1.0)
    return 0.05, 0.1 - 0.2 * share**2 * (3 - 2 * share), 1.5


def covered(image, position_m, part: float):
    """Lay a hand over the upper part of what is at a place."""
    pixels = np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.width, 3).copy()
    x, y, z = position_m
    side = 525.0 * 0.08 / z
    left, top = round(319.5 + 525.0 * x / z - side), round(239.5 + 525.0 * y / z - side)
    bottom = round(239.5 + 525.0 * y / z - side / 2 + part * side)
    pixels[max(top, 0) : bottom, left : left + round(2 * side)] = SKIN
    return image.model_copy(update={"data": pixels.tobytes()})


def tracked(image_of, pose_at, part: float, frames: int = 20, from_frame: int = 3):
    tracker = MarkerTracker(Settings(marker_size_m=0.08))
    listed = []
    for i in range(frames):
        image = image_of([(3, 0.08, pose_at(place(i)))], stamp_ns=i * SECOND_NS // RATE_HZ)
        (answer,) = tracker.handle(covered(image, place(i), part) if i >= from_frame else image)
        listed.append(answer.objects)
    return listed


@pytest.mark.parametrize("part", [0.1, 0.2])
def test_a_marker_under_a_finger_is_seen_where_it_goes(image_of, pose_at, part) -> None:
    listed = tracked(image_of, pose_at, part)
    for i, objects in enumerate(listed):
        assert [(found.id, found.seen) for found in objects] == [(3, True)], i
        if i > 2:
            assert np.linalg.norm(np.subtract(objects[0].position_m, place(i))) < 0.03


def test_a_wholly_covered_marker_is_not_seen(image_of, pose_at) -> None:
    listed = tracked(image_of, pose_at, 1.2)
    assert all(not found.seen for objects in listed[3:] for found in objects)


def test_nothing_is_followed_into_an_empty_image(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=0.08))
    [*tracker.handle(image_of([(3, 0.08, pose_at(place(0)))]))]
    (answer,) = tracker.handle(image_of(stamp_ns=SECOND_NS // RATE_HZ))
    assert [found.seen for found in answer.objects] == [False]


def test_a_marker_at_the_edge_of_the_image_does_no_harm(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=0.08))
    for i in range(8):
        image = image_of([(3, 0.08, pose_at((-0.75 - 0.03 * i, 0.0, 1.5)))], stamp_ns=i * SECOND_NS // RATE_HZ)
        (answer,) = tracker.handle(image)
        assert len(answer.objects) <= 1


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10**6), st.sampled_from([(64, 48), (320, 240), (641, 479), (1280, 40)]))
def test_any_image_of_any_size_may_come_next(image_of, pose_at, seed, size) -> None:
    width, height = size
    chance = np.random.default_rng(seed)
    tracker = MarkerTracker(Settings(marker_size_m=0.08, calibrated_size_px=None))
    [*tracker.handle(image_of([(3, 0.08, pose_at((*chance.uniform(-0.3, 0.3, 2), 1.5)))]))]
    for i in range(3):
        image = image_of(
            stamp_ns=(i + 1) * SECOND_NS // 60, width=width, height=height, data=chance.bytes(3 * width * height)
        )
        off_centre = [525.0, 0.0, (width - 1) / 2, 0.0, 525.0, (height - 1) / 2, 0.0, 0.0, 1.0]
        (answer,) = tracker.handle(image.model_copy(update={"K": off_centre}))
        assert answer.valid and not any(found.seen for found in answer.objects)
