"""What covers a marker is followed: a hand that came to rest on it takes it along, and nothing else does."""

import cv2
import numpy as np
import pytest

from actum.messages import TrackedObject
from actum.node import SECOND_NS
from marker_tracker.node import MarkerTracker
from marker_tracker.occlusion.crop import Crop
from marker_tracker.occlusion.occluder_tracker import MAX_TRACKED
from marker_tracker.settings import Settings

SIZE_M, FOCAL_PX, MIDDLE_PX = 0.08, 525.0, np.array([319.5, 239.5])
REST = np.array([0.05, 0.1, 1.5])
NOISE = cv2.GaussianBlur(np.random.default_rng(1).normal(0.0, 60.0, (96, 96)), (0, 0), 4)
HAND = np.clip(150 + 40 * NOISE / NOISE.std(), 40, 250).astype(np.uint8)
COVERED_S = 0.4
ASIDE = np.array([0.4, 0.0, 0.0])


def smoothly(start, end, since_s, until_s):
    def place(t):
        share = np.clip((t - since_s) / (until_s - since_s), 0.0, 1.0)
        return start + (end - start) * share**2 * (3 - 2 * share)

    return place


def with_hand(image, place_m, turn_deg=0.0):
    """Lay a hand of 13 cm over what is at a place: larger where it is nearer."""
    x, y, z = place_m
    pixels = np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.width, 3).copy()
    scale = 0.13 * FOCAL_PX / z / len(HAND)
    there = cv2.getRotationMatrix2D((47.5, 47.5), turn_deg, scale)
    there[:, 2] += MIDDLE_PX + FOCAL_PX * np.array([x, y]) / z - 47.5
    round_ = cv2.circle(np.zeros_like(HAND), (48, 48), 46, 255, -1)
    size = (image.width, image.height)
    drawn, mask = (cv2.warpAffine(part, there, size, flags=cv2.INTER_AREA) for part in (HAND, round_))
    pixels[mask > 127] = drawn[mask > 127, None]
    return image.model_copy(update={"data": pixels.tobytes()})


@pytest.fixture
def seen(image_of, pose_at):
    """Show a marker to a tracker, each image with a hand where it is then, if anywhere: what is listed, by time."""

    def watch(hand, until_s, rate_hz=15, object_at=lambda _t: REST, turn_deg=lambda _t: 0.0):
        tracker, listed = MarkerTracker(Settings(marker_size_m=SIZE_M)), {}
        for i in range(round(until_s * rate_hz) + 1):
            t, place = i / rate_hz, object_at(i / rate_hz)
            markers = [] if place is None else [(3, SIZE_M, pose_at(place))]
            image = image_of(markers, stamp_ns=round(t * SECOND_NS))
            at = hand(t)
            (answer,) = tracker.handle(image if at is None else with_hand(image, at, turn_deg(t)))
            listed[t] = answer.objects
        return listed

    return watch


def carried(end, rate_hz=15):
    """A hand that covers the object from `COVERED_S` on and takes it elsewhere."""
    place = smoothly(REST, np.array(end), COVERED_S + 0.15, COVERED_S + 0.9)
    return (lambda t: place(t) if t >= COVERED_S else None), place


def last(listed) -> TrackedObject:
    (found,) = listed[max(listed)]
    return found


@pytest.mark.parametrize("rate_hz", [15, 30])
@pytest.mark.parametrize("end", [(0.05, -0.1, 1.5), (0.05, 0.1, 1.3), (0.2, 0.0, 1.6)])
def test_an_object_in_the_hand_is_where_the_hand_takes_it(seen, end, rate_hz) -> None:
    hand, place = carried(end)
    found = last(seen(hand, 1.5, rate_hz, place))
    assert (found.seen, found.followed) == (False, True)
    assert np.linalg.norm(np.subtract(found.position_m, end)) < 0.02


def test_a_hand_may_turn_what_it_takes(seen) -> None:
    hand, place = carried((0.05, -0.1, 1.5))
    turning = smoothly(0.0, 25.0, COVERED_S + 0.15, COVERED_S + 0.9)
    found = last(seen(hand, 1.5, 30, place, turning))
    assert found.followed
    assert np.linalg.norm(np.subtract(found.position_m, (0.05, -0.1, 1.5))) < 0.02


def test_it_is_trusted_less_than_what_is_seen_and_is_seen_again_at_once(seen) -> None:
    _, place = carried((0.05, -0.1, 1.5))
    listed = seen(lambda t: place(t) if COVERED_S <= t < 1.5 else None, 1.6, 15, place)
    (before,), (covered,), (again,) = listed[0.0], listed[21 / 15], listed[max(listed)]
    assert covered.followed and 0 < covered.confidence < before.confidence
    assert again.seen and not again.followed
    assert np.linalg.norm(np.subtract(again.position_m, (0.05, -0.1, 1.5))) < 0.01


def test_a_hand_that_passes_takes_nothing_along(seen) -> None:
    passing = smoothly(REST + ASIDE, REST - ASIDE, 0.3, 1.1)
    for objects in seen(passing, 1.2, 30).values():
        assert np.linalg.norm(np.subtract(objects[0].position_m, REST)) < 0.01


def test_a_hand_that_goes_again_leaves_what_it_has_covered(seen) -> None:
    going = smoothly(REST, REST - (0.4, 0.2, 0), 0.9, 1.4)
    found = last(seen(lambda t: going(t) if t >= COVERED_S else None, 1.6, 30))
    assert found.seen
    assert np.linalg.norm(np.subtract(found.position_m, REST)) < 0.01


def test_what_stays_on_its_place_for_long_may_be_what_was_behind_it(seen) -> None:
    listed = seen(lambda t: REST if t >= COVERED_S else None, 4.0, object_at=lambda t: REST if t < COVERED_S else None)
    assert listed[1.0][0].followed
    assert listed[4.0] == []


def test_nothing_is_followed_that_leaves_no_trace(seen) -> None:
    listed = seen(lambda _: None, 1.0, object_at=lambda t: REST if t < COVERED_S else None)
    assert not any(found.followed for objects in listed.values() for found in objects)


def test_what_was_moving_when_it_was_covered_is_not_known_to_be_under_the_hand(seen) -> None:
    sliding = smoothly(REST, REST + ASIDE, 0.0, 0.8)
    listed = seen(lambda t: sliding(COVERED_S) if t >= COVERED_S else None, 1.0, 30, sliding)
    assert not any(found.followed for objects in listed.values() for found in objects)


def test_what_seems_to_come_nearer_at_once_is_not_believed(seen) -> None:
    hand, place = carried((0.05, -0.1, 1.5))
    listed = seen(lambda t: hand(t) if t < 1.0 else place(t) * 0.9, 1.1, 30, place)
    assert listed[29 / 30][0].followed
    assert not last(listed).followed
    assert last(listed).position_m[2] == pytest.approx(1.5, abs=0.02)


def test_over_a_long_gap_between_images_nothing_is_followed(seen) -> None:
    hand, place = carried((0.05, -0.1, 1.5))
    listed = seen(hand, 1.6, 2, place)
    assert not any(found.followed for objects in listed.values() for found in objects)


def test_another_marker_that_is_laid_on_it_takes_it_nowhere(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=SIZE_M))
    on_it = smoothly(REST, np.array([0.05, -0.15, 1.5]), 1.0, 1.6)
    for i in range(30):
        t = i / 15
        shown = (3, SIZE_M, pose_at(REST)) if t < COVERED_S else (7, SIZE_M, pose_at(on_it(t)))
        (answer,) = tracker.handle(image_of([shown], stamp_ns=round(t * SECOND_NS)))
        for found in answer.objects:
            assert found.id != 3 or np.linalg.norm(np.subtract(found.position_m, REST)) < 0.01


@pytest.mark.parametrize("middle_px", [-48 + 100j, 100 - 48j, 700 + 100j, 100 + 600j])
@pytest.mark.parametrize("scale", [0.2, 0.5, 1.0])
def test_beyond_the_images_edge_there_is_next_to_nothing_to_see(middle_px, scale) -> None:
    crop = Crop.around(np.zeros((480, 640), dtype=np.uint8), middle_px, 48.0, scale)
    assert min(crop.levels.shape) <= 1


@pytest.mark.parametrize("scale", [0.2, 0.5, 1.0])
def test_what_is_in_the_middle_of_the_image_s_pixels_is_in_the_middle_of_the_crop_s(scale) -> None:
    """A pixel of the crop is 1 / scale of the image's, from edge to edge."""
    crop, beside = Crop(np.zeros((9, 9)), 100 + 40j, scale), (1 / scale - 1) / 2 * (1 + 1j)
    assert crop.from_image(100 + 40j + beside) == pytest.approx(0)
    assert crop.from_image(100 + 40j + beside + (3 + 2j) / scale) == pytest.approx(3 + 2j)
    assert crop.to_image(3 + 2j) == pytest.approx(100 + 40j + beside + (3 + 2j) / scale)


@pytest.mark.parametrize("scale", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("middle_px", [320 + 240j, 333.3 + 217.9j, 20 + 30j])
def test_a_crop_shows_a_spot_where_it_says(scale, middle_px) -> None:
    columns, rows = np.meshgrid(np.arange(640), np.arange(480))
    spot = np.exp(-((columns - middle_px.real) ** 2 + (rows - middle_px.imag) ** 2) / (2 * 8.0**2))
    crop = Crop.around((200 * spot).astype(np.uint8), middle_px, 48.0, scale)
    columns, rows = np.meshgrid(*map(np.arange, crop.levels.shape[::-1]))
    weights = np.clip(crop.levels - crop.levels.max() / 2, 0, None)
    shown = complex(np.average(columns, weights=weights), np.average(rows, weights=weights))
    assert crop.from_image(middle_px) == pytest.approx(shown, abs=0.06)


def test_images_of_another_size_begin_anew(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=SIZE_M))
    image = image_of([(3, SIZE_M, pose_at(REST))])
    for i in range(5):
        [*tracker.handle(image.model_copy(update={"stamp_ns": i * SECOND_NS // 15}))]
    pixels = np.frombuffer(with_hand(image, REST).data, dtype=np.uint8).reshape(image.height, image.width, 3)
    large = np.ascontiguousarray(cv2.resize(pixels, (1280, 960)))
    for i in range(5, 10):
        fields = {"stamp_ns": i * SECOND_NS // 15, "width": 1280, "height": 960, "data": large.tobytes()}
        (answer,) = tracker.handle(image.model_copy(update=fields))
        assert not any(found.seen or found.followed for found in answer.objects)


def test_of_many_at_once_a_few_are_followed(image_of, pose_at) -> None:
    tracker = MarkerTracker(Settings(marker_size_m=0.05))
    places = [(x, y, 1.0) for x in (-0.4, -0.2, 0.0, 0.2, 0.4) for y in (-0.2, 0.1)]
    shown = image_of([(number, 0.05, pose_at(place)) for number, place in enumerate(places)])
    still = np.random.default_rng(0).integers(0, 255, (shown.height // 8, shown.width // 8), dtype=np.uint8)
    curtain = cv2.cvtColor(cv2.resize(still, (shown.width, shown.height)), cv2.COLOR_GRAY2BGR).tobytes()
    for i in range(8):
        fields = {"stamp_ns": i * SECOND_NS // 15} | ({"data": curtain} if i > 3 else {})
        (answer,) = tracker.handle(shown.model_copy(update=fields))
    assert 0 < sum(found.followed for found in answer.objects) <= MAX_TRACKED
