"""Messages that viewers show: a cup that is turned, and images of a camera that is not the skeletons'."""

from typing import Any

from actum.messages import Image, Objects, TrackedObject

STAMP_NS = 1_700_000_000_123_456_789
QUARTER_ABOUT_Z = [0.0, 0.0, 0.5**0.5, 0.5**0.5]
SKELETON_FROM_IMAGE = [0.0, -1.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0]


def cup(**fields: Any) -> TrackedObject:
    given = {"id": 3, "name": "cup", "position_m": [0.5, -0.25, 2.0], "quaternion_xyzw": QUARTER_ABOUT_Z}
    return TrackedObject.model_validate({**given, "confidence": 1.0, "seen": True, **fields})


def objects(stamp_ns: int, *tracked: TrackedObject) -> Objects:
    return Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=list(tracked))


def image(picture: str, data: bytes, distortion: int = 0) -> Image:
    """A picture of 2 x 1 pixels with so many numbers of distortion."""
    given = {"stamp_ns": STAMP_NS, "sensor": "kinect0", "format": picture, "width": 2, "height": 1, "data": data}
    camera = {"K": [500.0, 0, 320, 0, 510.0, 240, 0, 0, 1], "distortion": [0.1] * distortion}
    return Image.model_validate({**given, **camera, "skeleton_from_image": SKELETON_FROM_IMAGE})
