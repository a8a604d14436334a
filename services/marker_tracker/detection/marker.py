"""A detected marker."""

import math
from dataclasses import dataclass
from functools import cached_property

from actum.arrays import Array

Key = tuple[str, int]
"""Identifies a marker: OpenCV's name of its family, and its id in the family."""


@dataclass(frozen=True)
class AlignmentStart:
    """Initial values for the alignment of a small marker in the next image.

    Attributes:
        corners_px: (4, 2), the initial corners of the last alignment, moved along with the marker: the same initial
            corners give a static marker the same result in every image.
        photometric: (3,) blur in cells, black level and contrast, as aligned last.
        motion_px: (2,) motion of the centre since the previous image.
    """

    corners_px: Array
    photometric: Array
    motion_px: Array


@dataclass(frozen=True)
class Marker:
    """A marker in an image.

    Attributes:
        family: OpenCV's name of the family.
        id: in the family.
        corners_px: (4, 2), clockwise from the marker's own top left.
        wrong: number of misread cells, the border's included.
        covered: share of a small marker, 0 to 1, whose grey levels do not fit its pattern.
        initial_px: (4, 2), the corners before refinement, clockwise from any of them.
        start: initial values for alignment in the next image, if the marker was aligned and is clear.
        hidden: whether it is wholly covered; its corners are then inferred from the motion of its occluder.
    """

    family: str
    id: int
    corners_px: Array
    wrong: int = 0
    covered: float = 0.0
    initial_px: Array | None = None
    start: AlignmentStart | None = None
    hidden: bool = False

    @property
    def key(self) -> Key:
        """Family and id."""
        return self.family, self.id

    @cached_property
    def side_px(self) -> float:
        """Mean length of the four sides."""
        first, second, third, fourth = self.corners_px.tolist()
        dist = math.dist
        return (dist(first, fourth) + dist(second, first) + dist(third, second) + dist(fourth, third)) / 4

    @cached_property
    def centre_px(self) -> Array:
        """Mean of the corners: (2,)."""
        centre: Array = self.corners_px.sum(axis=0) / 4
        return centre
