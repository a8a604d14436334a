"""What is kept of one agent from frame to frame."""

from dataclasses import dataclass, field

from actum.messages import Joint
from pose_preprocessor.heading import HeadingFilter
from pose_preprocessor.motion import MotionFilter


@dataclass
class Person:
    """An agent's last usable joints as they came, and their filters."""

    joints: list[Joint] | None = None
    motion: MotionFilter = field(default_factory=MotionFilter)
    heading: HeadingFilter = field(default_factory=HeadingFilter)
