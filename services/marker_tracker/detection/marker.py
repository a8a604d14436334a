"""A detected marker."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from actum.arrays import Array

Key = tuple[str, int]
"""Which marker: its family, by OpenCV's name, and its id there."""


@dataclass(frozen=True)
class AlignmentStart:
    """Where the alignment of a small marker begins in the next image.

    Attributes:
        corners_px: (4, 2) from which the last alignment began, moved along with the marker: the same start gives a
            resting marker the same corners in every image.
        photometric: (3,) blur in cells, black level and contrast, as aligned last.
        motion_px: (2,) by which the centre moved from the image before.
    """

    corners_px: Array
    photometric: Array
    motion_px: Array


@dataclass(frozen=True)
class Marker:
    """A marker in an image.

    Attributes:
        family: OpenCV's name of it.
        id: in the family.
        corners_px: (4, 2), clockwise from the marker's own top left.
        wrong: cells that were misread, the border's included.
        covered: the share of a small marker, 0 to 1, whose grey levels are not of its pattern.
        initial_px: (4, 2) from which the corners were refined, clockwise from any of them.
        start: where alignment begins in the next image, if the marker was aligned and is clear.
        hidden: it is wholly covered; its corners moved with what covers it.
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
        """Which marker it is."""
        return self.family, self.id

    @cached_property
    def side_px(self) -> float:
        """Mean length of the four sides."""
        sides = self.corners_px - self.corners_px[[3, 0, 1, 2]]
        return float(np.sqrt((sides * sides).sum(axis=1)).mean())

    @cached_property
    def centre_px(self) -> Array:
        """Mean of the corners: (2,)."""
        centre: Array = self.corners_px.sum(axis=0) / 4
        return centre
