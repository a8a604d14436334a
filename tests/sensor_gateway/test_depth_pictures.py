"""What a depth camera knows of itself: its clock, its silence, its lens."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.calibration import Calibration
from actum.messages import Image, Skeleton
from actum.node import Counters
from realsense_devices import Known
from rendered_bodies import depth_of, landmarks_of, person
from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.device_clock import DeviceClock
from sensor_gateway.devices.silence import OPENING_S, SILENT_S, Silence
from sensor_gateway.lens import Lens
from sensor_gateway.optics import DepthOptics
from sensor_gateway.perceiver import Perceiver

WIDTH, HEIGHT = 320, 240
LENS = Lens(np.array([[300.0, 0, 160.0], [0, 300.0, 120.0], [0, 0, 1]]), np.zeros(5), assumed=False)
BODY = person()
K = [310.0, 0.0, 158.0, 0.0, 311.0, 119.0, 0.0, 0.0, 1.0]


def picture() -> DepthPicture:
    depth_m = depth_of(BODY, LENS, WIDTH, HEIGHT)
    return DepthPicture(np.zeros((HEIGHT, WIDTH, 3), np.uint8), 5, depth_m, LENS)


def calibration(width: int) -> Calibration:
    return Calibration(image_size=(width, HEIGHT), K=K, distortion=[])


def seen(optics: DepthOptics, one: Picture) -> tuple[list[Image], Skeleton]:
    marks = landmarks_of(BODY, LENS, model_size=1.05)
    *images, skeleton = Perceiver(Known(marks), optics, "kinect0", "test", Counters()).messages(one)
    assert isinstance(skeleton, Skeleton)
    return [image for image in images if isinstance(image, Image)], skeleton


def test_people_in_a_picture_with_depth_are_lifted_and_the_image_has_the_devices_lens() -> None:
    [image], skeleton = seen(DepthOptics(), picture())

    assert np.linalg.norm(np.array(skeleton.agents[0].joints) - BODY.joints_m, axis=1).max() < 0.025
    assert LENS.matrix.ravel().tolist() == image.K
    assert not image.intrinsics_assumed


def test_a_calibration_goes_before_the_devices_lens() -> None:
    [image], skeleton = seen(DepthOptics(calibration=calibration(WIDTH)), picture())

    assert image.K == K
    assert skeleton.valid


@given(st.lists(st.integers(0, 2**40), min_size=1, max_size=20))
def test_a_devices_intervals_are_kept_and_the_first_stamp_is_the_hosts_time(stamps: list[int]) -> None:
    clock, rising = DeviceClock(lambda: 10**18), sorted(stamps)
    told = [clock.stamp_ns(stamp) for stamp in rising]

    assert told == [10**18 + stamp - rising[0] for stamp in rising]


def test_a_device_that_counts_from_its_start_again_goes_on_in_the_hosts_time() -> None:
    now_ns = [10**18]
    clock = DeviceClock(lambda: now_ns[0])
    assert clock.stamp_ns(7 * 10**9) == 10**18
    now_ns[0] += 5 * 10**9

    assert clock.stamp_ns(3) == 10**18 + 5 * 10**9


def test_a_device_may_take_longer_for_its_first_picture_than_for_the_others() -> None:
    now_s = [0.0]
    silence = Silence(lambda: now_s[0])
    now_s[0] = OPENING_S - 0.1
    silence.check()
    silence.heard()
    now_s[0] += SILENT_S - 0.1
    silence.check()
    now_s[0] += 0.2

    with pytest.raises(CameraLostError, match="the camera sent no picture for 2 s"):
        silence.check()
