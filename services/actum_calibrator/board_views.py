"""Detects the board's corners in an image, refines them to fractions of a pixel, and refuses blurred images."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from actum.arrays import Array, Pixels
from actum_calibrator.blur import blur_px, image_blur_px, image_from_plane
from actum_calibrator.board import Board
from actum_calibrator.grey_images import BlurredError, UnusablePictureError

FEWEST_CORNERS = 8  # twice as many as a pose needs, so that the view also constrains the camera
MOST_BLUR_PX = 2.0  # standard deviation; beyond it corners are biased by the markers beside them
MOST_BLUR_OF_DIAGONAL = 1e-3  # share of the image's diagonal: the limit for large images
WINDOW_PX = (2, 20)  # least and most half width of the windows in which corners are refined
BLINDING_SHARE = 0.65  # share of the largest blur above which blur is named as the cause when no board is found
REFINEMENT = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
"""When the refinement of a corner ends: after 100 iterations, or a step of 1e-4 px."""


@dataclass(frozen=True)
class View:
    """Corners of the board in one image: n `ids` and `corners_px` (n, 2); `size` is (width, height) in px."""

    name: str
    size: tuple[int, int]
    board: Board
    ids: list[int]
    corners_px: Array
    blur_px: float

    @property
    def corners_m(self) -> Array:
        """The same corners (n, 3) in the board's frame, in metres."""
        return self.board.corners_m[self.ids]

    @property
    def diagonal_px(self) -> float:
        """Diagonal of the image."""
        return math.hypot(*self.size)

    def outline_px(self) -> Array:
        """Return the board's four outer corners (4, 2) in the image, by the homography, visible or not."""
        image_from_board = image_from_plane(self.board, self.ids, self.corners_px)
        return np.asarray(cv2.perspectiveTransform(self.board.outline_m[None], image_from_board)[0], dtype=np.float64)


class BoardFinder:
    """Finds one board in images."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self._detector = cv2.aruco.CharucoDetector(board.opencv)

    def find(self, pixels: Pixels, name: str) -> View:
        """Find the board in grey levels (height, width).

        Raises:
                UnusablePictureError: there is no board, too few corners are visible, or the image is blurred.
        """
        corners, numbers, _, _ = self._detector.detectBoard(pixels)
        ids = [] if numbers is None else [int(number) for number in np.ravel(numbers)]
        if len(ids) < FEWEST_CORNERS or self._in_line(ids):
            raise _unfound(pixels, name, len(ids))
        corners_px = self._refined(pixels, ids, np.reshape(corners, (-1, 2)).astype(np.float64))
        height, width = pixels.shape
        blur = blur_px(pixels, self._board, ids, corners_px)
        if blur > (limit_px := _most_blur_px(pixels)):
            raise BlurredError(
                name,
                f"the picture is blurred by {blur:.1f} px; at most {limit_px:.1f} px are allowed: hold the board still",
            )
        return View(name, (width, height), self._board, ids, corners_px, blur)

    def _refined(self, pixels: Pixels, ids: list[int], corners_px: Array) -> Array:
        """Refine corners (n, 2) in windows that just exclude the markers beside them, which would bias the corners."""
        reach = int(np.clip(round(self._margin_px(ids, corners_px)), *WINDOW_PX))
        start = corners_px.astype(np.float32).reshape(-1, 1, 2)
        refined = cv2.cornerSubPix(pixels, start, (reach, reach), (-1, -1), REFINEMENT)
        return np.asarray(refined, dtype=np.float64).reshape(-1, 2)

    def _margin_px(self, ids: list[int], corners_px: Array) -> float:
        """Return the width (px) of the white around the markers, along the axis that is foreshortened more."""
        image_from_board = image_from_plane(self._board, ids, corners_px)
        middle, margin = self._board.outline_m.mean(axis=0), self._board.margin_m
        ends = middle + margin * np.array([[0, 0], [1, 0], [0, 1]])
        start, right, down = cv2.perspectiveTransform(ends[None], image_from_board)[0]
        return float(min(np.linalg.norm(right - start), np.linalg.norm(down - start)))

    def _in_line(self, ids: list[int]) -> bool:
        points = self._board.corners_m[ids][:, :2]
        return int(np.linalg.matrix_rank(points - points[0], tol=1e-6)) < 2


def _unfound(pixels: Pixels, name: str, corners: int) -> UnusablePictureError:
    """Return the error with the reason why the board was not found."""
    blur = image_blur_px(pixels)
    if blur is None:
        return UnusablePictureError(name, "the picture is too dark, too bright or empty")
    if blur > BLINDING_SHARE * _most_blur_px(pixels):
        return BlurredError(name, f"the picture is blurred by about {blur:.1f} px, too much to find the board")
    if corners == 0:
        return UnusablePictureError(name, "no board was found in the picture")
    return UnusablePictureError(name, f"only {corners} corners of the board were found in the picture")


def _most_blur_px(pixels: Pixels) -> float:
    return max(MOST_BLUR_PX, MOST_BLUR_OF_DIAGONAL * math.hypot(*pixels.shape))
