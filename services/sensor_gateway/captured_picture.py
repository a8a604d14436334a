"""A captured picture: a stamped colour image, and perhaps depth, or people whom the device's software tracks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.messages import Agent
from sensor_gateway.lens import Lens

DepthImage = NDArray[np.float32]
"""Depth along the optical axis (height, width; m), 0 where it is unknown."""


@dataclass(frozen=True, eq=False)
class Picture:
    """One captured image (height, width, 3), BGR, and the time of its capture."""

    image_bgr: NDArray[np.uint8]
    stamp_ns: int


@dataclass(frozen=True, eq=False)
class DepthPicture(Picture):
    """A picture with registered depth (height, width; m, 0 where it is unknown), and the device's lens."""

    depth_m: DepthImage
    lens: Lens


@dataclass(frozen=True, eq=False)
class UsersPicture(DepthPicture):
    """A picture with the people whom the device's own software tracks."""

    agents: tuple[Agent, ...]
