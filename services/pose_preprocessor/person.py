"""What is kept of one agent from frame to frame."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from actum import geometry
from actum.messages import Joint
from pose_preprocessor.bridging import Bridge
from pose_preprocessor.heading import HeadingFilter
from pose_preprocessor.part_motion import PartMotionFilter

Array = NDArray[np.float64]


@dataclass
class Person:
    """An agent's last usable joints as they came, and their filters."""

    joints: list[Joint] | None = None
    bridge: Bridge = field(default_factory=Bridge)
    motion: PartMotionFilter = field(default_factory=PartMotionFilter)
    heading: HeadingFilter = field(default_factory=HeadingFilter)

    def upright(self, stamp_ns: int, joints: Array, scaled: Array) -> Array:
        """Express scaled joints (15, 3) along gravity and the smoothed heading of the measured ones, level camera."""
        return geometry.upright(scaled, *self.heading.step(stamp_ns, joints))
