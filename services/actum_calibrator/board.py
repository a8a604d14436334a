"""Printed patterns: single markers and the ChArUco board, by their dimensions."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from actum.arrays import Array, Mask

FEWEST_SQUARES = 3  # in each direction: fewer have too few inner corners
MOST_SQUARES = 50  # in each direction: more are too small to be detected
LARGEST_SQUARE_M = 1.0  # a larger number is in mm by mistake


class PatternError(ValueError):
    """An impossible marker or board; the message names the problem and what is possible."""


def families() -> list[str]:
    """List the marker families by OpenCV's names."""
    return sorted(entry for entry in dir(cv2.aruco) if entry.startswith("DICT_"))


def canonical(family: str) -> str:
    """Return OpenCV's name of a family, from a name in any letter case, with or without DICT_.

    Raises:
        PatternError: there is no family of that name.
    """
    if family in families():
        return family
    sought = "DICT_" + family.upper().removeprefix("DICT_")
    alike = [name for name in families() if name.upper() == sought]
    if not alike:
        raise PatternError(f"{family!r} is not a marker family: use one of {', '.join(families())}")
    return alike[-1]


def dictionary_of(family: str) -> Any:
    """Return OpenCV's dictionary of a family.

    Raises:
        PatternError: there is no family of that name.
    """
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, canonical(family)))


def black_cells(family: str, marker_id: int) -> Mask:
    """Return which cells (n, n) of a marker are black, its black border included, row by row from its top left.

    Raises:
        PatternError: the family has no such id.
    """
    dictionary = dictionary_of(family)
    count = len(dictionary.bytesList)
    if not 0 <= marker_id < count:
        raise PatternError(f"the marker family {family} has no marker {marker_id}: use ids from 0 to {count - 1}")
    side = dictionary.markerSize + 2
    black: Mask = np.asarray(cv2.aruco.generateImageMarker(dictionary, marker_id, side)) == 0
    return black


@dataclass(frozen=True)
class Board:
    """A ChArUco board: `columns` x `rows` squares, a marker in each white one.

    Its frame has the origin at the top left outer corner, x to the right, y down, z into the print.

    Raises:
        PatternError: a board of these dimensions is impossible.
    """

    columns: int = 7
    rows: int = 5
    square_m: float = 0.035
    marker_m: float = 0.026
    family: str = "DICT_5X5_100"

    def __post_init__(self) -> None:
        if not all(FEWEST_SQUARES <= count <= MOST_SQUARES for count in (self.columns, self.rows)):
            raise PatternError(
                f"a board of {self.columns}x{self.rows} squares cannot be made: use 3 to 50 squares in each direction"
            )
        if not 0 < self.marker_m < self.square_m <= LARGEST_SQUARE_M:
            raise PatternError(
                f"a board with markers of {self.marker_m * 1000:g} mm in squares of {self.square_m * 1000:g} mm cannot "
                "be made: the markers have to be smaller than the squares, and the squares at most 1000 mm wide"
            )
        if (needed := self.columns * self.rows // 2) > (available := len(dictionary_of(self.family).bytesList)):
            raise PatternError(
                f"the board needs {needed} markers, but the marker family {self.family} has only {available}: use "
                "fewer squares, or a family with more markers"
            )

    @property
    def width_m(self) -> float:
        """Width of all squares."""
        return self.columns * self.square_m

    @property
    def height_m(self) -> float:
        """Height of all squares."""
        return self.rows * self.square_m

    @property
    def margin_m(self) -> float:
        """Width of the white between a marker and the edge of its square."""
        return (self.square_m - self.marker_m) / 2

    @cached_property
    def corners_m(self) -> Array:
        """Inner corners (n, 3) in metres, in the order of their ids; z = 0."""
        return np.asarray(self.opencv.getChessboardCorners(), dtype=np.float64)

    @cached_property
    def outline_m(self) -> Array:
        """The four outer corners (4, 2) in metres, clockwise from the origin."""
        return np.array([[0, 0], [self.width_m, 0], [self.width_m, self.height_m], [0, self.height_m]])

    @cached_property
    def opencv(self) -> Any:
        """The board as an OpenCV object."""
        size = (self.columns, self.rows)
        return cv2.aruco.CharucoBoard(size, self.square_m, self.marker_m, dictionary_of(self.family))

    def __str__(self) -> str:
        """Describe the board in the terms of the command's options."""
        return (
            f"{self.columns}x{self.rows} squares of {self.square_m * 1000:g} mm, "
            f"markers {self.family} of {self.marker_m * 1000:g} mm"
        )
