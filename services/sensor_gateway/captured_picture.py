"""What a device captures: a colour image with its stamp, and perhaps depth, or people that the device itself tracks."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent
from sensor_gateway.lens import Lens

DepthImage = NDArray[np.float32]
"""Distances along the optical axis (height, width; m), 0 where there is none."""


@dataclass(frozen=True, eq=False)
class Picture:
    """One captured image (height, width, 3), BGR, and the time of its capture."""

    image_bgr: NDArray[np.uint8]
    stamp_ns: int


@dataclass(frozen=True, eq=False)
class DepthPicture(Picture):
    """A picture, the depth (height, width; m, 0 where there is none) of each of its pixels, and the device's lens."""

    depth_m: DepthImage
    lens: Lens


@dataclass(frozen=True, eq=False)
class UsersPicture(DepthPicture):
    """A picture with the people whom the device's own software tracks."""

    agents: tuple[Agent, ...]


def unmirrored(picture: Picture) -> Picture:
    """Flip a mirror image back: in it the actor's left would be their right, and no marker could be read."""
    return replace(picture, image_bgr=np.ascontiguousarray(picture.image_bgr[:, ::-1]))
