"""Real photographs of a tag turned about its own upright axis by known angles."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from actum.messages import Image, TrackedObject
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import Settings

K = [329.87, 0.0, 528.0, 0.0, 332.95, 396.0, 0.0, 0.0, 1.0]
IDENTITY = np.eye(4).ravel().tolist()


def the_tag(data: Path, degrees: int) -> TrackedObject:
    file = data / "markers" / "dt_apriltags" / f"test_image_rotation_{degrees}.png"
    pixels = cv2.imread(str(file))
    height, width = pixels.shape[:2]
    image = Image(
        stamp_ns=0, sensor="kinect0", format="bgr8", width=width, height=height, data=pixels.tobytes(),
        K=K, distortion=[], skeleton_from_image=IDENTITY,
    )  # fmt: skip
    tracker = MarkerTracker(Settings(dictionary="DICT_APRILTAG_36H11", marker_size_m=0.065))
    (answer,) = tracker.handle(image)
    (tag,) = answer.objects
    return tag


@pytest.mark.data
@pytest.mark.parametrize("degrees", [-60, -20, 20, 40, 60])
def test_the_tag_has_turned_as_far_as_it_was_turned(data, degrees) -> None:
    straight, turned = the_tag(data, 0), the_tag(data, degrees)
    cosine = abs(np.dot(straight.quaternion_xyzw, turned.quaternion_xyzw))
    assert straight.id == turned.id == 76
    assert np.degrees(2 * np.arccos(min(cosine, 1.0))) == pytest.approx(abs(degrees), abs=5.0)
    assert np.allclose(straight.position_m, turned.position_m, atol=0.02)
