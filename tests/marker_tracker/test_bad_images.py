"""Calibrations of another size, and images of any bytes, are counted, answered as invalid and survived."""

import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import Image
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings

IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def jpeg_header(width: int, height: int) -> bytes:
    """Write a JPEG by hand up to and with its frame header: SOI, APP0, SOF0 of one component, SOS."""
    app0 = b"\xff\xe0\x00\x10JFIF\x00\x01\x01\x00\x00\x01\x00\x01\x00\x00"
    sof0 = b"\xff\xc0" + struct.pack(">HBHHB", 11, 8, height, width, 1) + b"\x01\x11\x00"
    sos = b"\xff\xda\x00\x08\x01\x01\x00\x00\x3f\x00"
    return b"\xff\xd8" + app0 + sof0 + sos


def small(**fields: Any) -> Image:
    message = {
        "stamp_ns": 1,
        "sensor": "kinect0",
        "format": "bgr8",
        "width": 64,
        "height": 48,
        "data": bytes(64 * 48 * 3),
        "K": [60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0],
        "distortion": [],
        "skeleton_from_image": IDENTITY,
    }
    return Image.model_validate(message | fields)


OTHER_SIZES = {
    "half": small(width=32, height=24, data=bytes(32 * 24 * 3)),
    "double": small(width=128, height=96, data=bytes(128 * 96 * 3)),
    "turned": small(width=24, height=64, data=bytes(24 * 64 * 3)),
}


@pytest.mark.parametrize("image", OTHER_SIZES.values(), ids=OTHER_SIZES.keys())
def test_a_size_that_the_calibration_cannot_be_of_is_counted(image) -> None:
    tracker = MarkerTracker(Settings())
    (answer,) = tracker.handle(image)
    assert tracker.counters.rejects == {"calibration_size_mismatch": 1}
    assert (answer.valid, answer.objects) == (False, [])
    assert f"{image.width}x{image.height}" in answer.reason


@pytest.mark.parametrize(("focal_px", "usable"), [(-1.0, False), (0.0, False), (0.5, True), (60.0, True)])
def test_a_focal_length_has_to_be_above_zero(focal_px: float, usable: bool) -> None:
    for at in (0, 4):
        matrix = [60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0]
        matrix[at] = focal_px
        tracker = MarkerTracker(Settings())
        tracker.handle(small(K=matrix))
        assert tracker.counters.rejects == {"black_image" if usable else "bad_calibration": 1}


def test_a_calibration_of_another_aspect_is_counted() -> None:
    tracker = MarkerTracker(Settings(calibrated_size_px=(64, 64)))
    (answer,) = tracker.handle(small())
    assert tracker.counters.rejects == {"calibration_size_mismatch": 1}
    assert "the image is 64x48, but the camera was calibrated at 64x64" in answer.reason


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_a_calibration_of_the_same_aspect_is_scaled(image_of, pose_at, scale) -> None:
    image = image_of([(3, 0.12, pose_at((0.1, -0.05, 0.8)))])
    k = [scale * 525.0, 0.0, scale * 320 - 0.5, 0.0, scale * 525.0, scale * 240 - 0.5, 0.0, 0.0, 1.0]
    size = (round(scale * 640), round(scale * 480))
    tracker = MarkerTracker(Settings(marker_size_m=0.12, calibrated_size_px=size))
    (answer,) = tracker.handle(image.model_copy(update={"K": k}))
    assert answer.objects[0].position_m == pytest.approx([0.1, -0.05, 0.8], abs=0.005)


def test_a_marker_in_the_dark_is_found(image_of, pose_at) -> None:
    image = image_of([(3, 0.05, pose_at((0.0, 0.0, 0.8)))])
    pixels = np.frombuffer(image.data, np.uint8).reshape(480, 640, 3)
    shown = np.pad(pixels[210:270, 290:350], ((210, 210), (290, 290), (0, 0)))
    (answer,) = MarkerTracker(Settings()).handle(image.model_copy(update={"data": shown.tobytes()}))
    assert answer.valid
    assert [found.id for found in answer.objects] == [3]


@settings(max_examples=200)
@given(st.binary(max_size=300), st.sampled_from([b"", b"\xff\xd8", b"\xff\xd8\xff\xe1", jpeg_header(64, 48)]))
def test_random_bytes_are_survived(tail, head) -> None:
    tracker = MarkerTracker(Settings())
    (answer,) = tracker.handle(small(format="jpeg", data=head + tail))
    assert answer.valid == (not tracker.counters.rejects)


@settings(max_examples=100)
@given(st.integers(1, 40), st.integers(1, 40), st.randoms())
def test_tiny_images_of_noise_are_survived(width, height, random) -> None:
    tracker = MarkerTracker(Settings())
    k = [60.0, 0.0, width / 2, 0.0, 60.0, height / 2, 0.0, 0.0, 1.0]
    (answer,) = tracker.handle(small(width=width, height=height, data=random.randbytes(width * height * 3), K=k))
    assert (answer.valid, answer.objects) == (not tracker.counters.rejects, [])


finite = st.floats(allow_nan=False, allow_infinity=False)
calibrated = st.floats(-100, 100)


def test_no_calibration_breaks_the_tracker(image_of, pose_at) -> None:
    image = image_of([(3, 0.12, pose_at((0.0, 0.0, 0.8), (0.4, 0.0, 0.0)))])

    @settings(max_examples=100)
    @given(
        st.lists(st.one_of(finite, calibrated), min_size=4, max_size=4),
        st.lists(st.one_of(finite, calibrated), max_size=14),
    )
    def check(k: list[float], distortion: list[float]) -> None:
        matrix = [k[0], 0.0, k[1], 0.0, k[2], k[3], 0.0, 0.0, 1.0]
        tracker = MarkerTracker(Settings())
        (answer,) = tracker.handle(image.model_copy(update={"K": matrix, "distortion": distortion}))
        assert all(math.isfinite(number) for found in answer.objects for number in found.position_m)
        assert answer.objects or tracker.counters.rejects

    check()
