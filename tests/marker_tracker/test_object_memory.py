"""An object that is covered stays listed for a second, by stamps, and is then forgotten."""

from typing import Any

import pytest

from actum.messages import Image
from actum.node import SECOND_NS, Tick
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings


@pytest.fixture
def tracker() -> MarkerTracker:
    return MarkerTracker(Settings(marker_size_m=0.12, memory_s=1.0))


@pytest.fixture
def cup(image_of, pose_at) -> Image:
    return image_of([(3, 0.12, pose_at((0.1, 0.0, 0.8)))])


@pytest.fixture
def nothing(image_of) -> Image:
    return image_of()


def at(image: Image, stamp_s: float, **fields: Any) -> Image:
    return image.model_copy(update={"stamp_ns": round(stamp_s * SECOND_NS), **fields})


def test_a_covered_object_keeps_its_place_and_loses_confidence(tracker, cup, nothing) -> None:
    (seen,) = tracker.handle(at(cup, 10.0))
    (covered,) = tracker.handle(at(nothing, 10.25))
    assert not covered.objects[0].seen
    assert covered.objects[0].position_m == seen.objects[0].position_m
    assert covered.objects[0].confidence == pytest.approx(0.75 * seen.objects[0].confidence)


def test_it_is_dropped_after_the_memorys_length(tracker, cup, nothing) -> None:
    list(tracker.handle(at(cup, 10.0)))
    (last,) = tracker.handle(at(nothing, 11.0))
    (after,) = tracker.handle(at(nothing, 11.05))
    assert [found.id for found in last.objects] == [3]
    assert after.objects == []


def test_it_is_seen_again_when_uncovered(tracker, cup, nothing) -> None:
    for image in (at(cup, 10.0), at(nothing, 10.5)):
        list(tracker.handle(image))
    (again,) = tracker.handle(at(cup, 10.6))
    assert again.objects[0].seen


def test_a_new_session_forgets_the_old_objects(tracker, cup, nothing) -> None:
    list(tracker.handle(at(cup, 10.0, session_id="a")))
    (answer,) = tracker.handle(at(nothing, 10.1, session_id="b"))
    assert (answer.objects, answer.session_id) == ([], "b")


def test_an_invalid_image_is_passed_on_as_invalid_objects(tracker, cup) -> None:
    (answer,) = tracker.handle(at(cup, 10.0, valid=False, reason="lens covered"))
    assert (answer.valid, answer.reason, answer.objects) == (False, "lens covered", [])
    assert answer.stamp_ns == 10 * SECOND_NS


def test_depth_images_and_ticks_are_none_of_its_business(tracker, cup) -> None:
    depth = cup.model_copy(update={"format": "depth16_mm"})
    assert list(tracker.handle(depth)) == []
    assert list(tracker.handle(Tick(1))) == []
