"""The first map's input: which joints of a posture, along which axes, from which origin (paper, section 2.1)."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Floats, Mask
from actum.skeletons import INDEX, JOINTS, PARTS
from actum.standard_body import BONES

Axes = Literal["posture", "upright"]
Origin = Literal["torso", "hips"]

PART_NAMES: tuple[str, ...] = tuple(PARTS)
MOVING = "moving"
"""Attention goes to the part that moves most over a segment."""
ALL = "all"
"""Attention goes to the whole body."""
ATTENTIONS: tuple[str, ...] = (MOVING, ALL, *PART_NAMES)
_PART_JOINTS = np.array(list(PARTS.values()))
CHOICES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"axes": get_args(Axes), "origin": get_args(Origin), "attention": ATTENTIONS}
)
_HIPS = [INDEX["left_hip"], INDEX["right_hip"]]
_TORSO = INDEX["torso"]
_NECK_FROM_TORSO = np.array([0.0, next(length_m for _, end, length_m in BONES if end == INDEX["neck"]), 0.0])


@dataclass(frozen=True)
class PostureInput:
    """The first map's input.

    Attributes:
        axes: `posture`, the paper's, from hips and torso of every posture anew; `upright`, gravity and the actor's
            heading, smoothed over time.
        origin: the torso, or the middle of the hips, about where the paper's point 0 lies; where a hip is unknown, the
            point as far below the torso as the neck usually is above it.
        attention: the part that moves most over a segment (`moving`), one part by its name, or the whole body (`all`).

    Raises:
        ValueError: an attribute has a value that is not listed here.
    """

    axes: Axes
    origin: Origin
    attention: str

    def __post_init__(self) -> None:
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise ValueError(f"{value!r} is not a valid value of {name}: use one of {', '.join(choices)}")

    @property
    def size(self) -> int:
        """The length of an input vector."""
        return 3 * len(JOINTS) if self.attention == ALL else 3 * _PART_JOINTS.shape[1]

    def rows(self, joints: Array, upright: Array) -> Array:
        """Return one frame's input vectors, one for each part that attention may choose, shape (choices, size).

        Where attention is `all`, there is a single choice, the whole body.

        Args:
            joints: (15, 3), scaled, along the axes of the posture.
            upright: (15, 3), scaled, upright, from the torso.
        """
        points = joints if self.axes == "posture" else upright
        relative: Array = points - (_hips(points) if self.origin == "hips" else points[_TORSO])
        return relative.reshape(1, -1) if self.attention == ALL else relative[_PART_JOINTS].reshape(len(PARTS), -1)

    def joints(self, rows: Floats) -> Array:
        """Return the joints (n, 15, 3) that input vectors (choices, n, size) of the same n frames consist of."""
        frames = rows.shape[1]
        joints = np.empty((frames, len(JOINTS), 3))
        chosen = slice(None) if self.attention == ALL else _PART_JOINTS
        joints[:, chosen] = rows.swapaxes(0, 1).reshape(joints[:, chosen].shape)
        return joints

    def attended(self, motion: Array, present: Mask) -> tuple[int, int]:
        """Return the index of the part that is attended to over a segment, and that of its row among `rows`.

        Args:
            motion: (n, 5), each part's displacement (m) since the frame before.
            present: (choices,), which of the rows have a known joint in at least one frame.
        """
        if self.attention == ALL:
            return attended_part(motion), 0
        part = attended_part(motion, None if self.attention == MOVING else self.attention, present)
        return part, part


def _hips(points: Array) -> Array:
    """Return the middle of the hips (3,) of joints (15, 3), estimated from the torso where a hip is unknown."""
    hips: Array = points[_HIPS].mean(axis=0)
    return points[_TORSO] - _NECK_FROM_TORSO if np.isnan(hips).any() else hips


def attended_part(motion: NDArray[Any], fixed: str | None = None, present: Mask | None = None) -> int:
    """Return the index of the part that moves most over a segment, or of the fixed one; of equals the first in `PARTS`.

    A part without a known joint in any frame is chosen only where no part has one.

    Args:
        motion: (n, 5), each part's displacement (m) since the frame before. The first row is motion from
            before the segment and does not count.
        fixed: a name of `skeletons.PARTS`, or None for the part that moves most.
        present: (5,), which parts have a known joint in at least one frame; all where None.
    """
    if fixed is not None and (present is None or present[PART_NAMES.index(fixed)]):
        return PART_NAMES.index(fixed)
    moved = motion[1:].sum(axis=0)
    return int(np.argmax(moved if present is None else np.where(present, moved, -1.0)))
