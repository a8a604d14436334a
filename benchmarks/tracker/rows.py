"""What is compared: OpenCV's detection with each of its corner refinements, ours, and ours with a part of it left out.

A part is left out by replacing a function of the tracker for the run.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np

from marker_tracker.detection import decoding, detector
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.families import family as family_of
from marker_tracker.detection.marker import Marker

from .rendering import Pixels

Detect = Callable[[int, Pixels], list[Marker]]
"""Find the markers of the next image, of a stamp in ns."""
Replacement = tuple[object, str, Any]
"""An object, the name of one of its attributes, and what stands there instead."""


@dataclass(frozen=True)
class Row:
    """One way to find markers: `begin(family, ids)` anew for each scene, with some functions replaced."""

    begin: Callable[[str, Sequence[int]], Detect]
    without: Sequence[Replacement] = ()

    @contextmanager
    def running(self, family: str, ids: Sequence[int]) -> Iterator[Detect]:
        """Replace what the row leaves out, and begin a scene."""
        with ExitStack() as stack:
            for where, name, instead in self.without:
                stack.enter_context(patch.object(where, name, instead))
            yield self.begin(family, ids)


def _opencv(refinement: int, origin_px: float = 0.0) -> Row:
    """Detect by OpenCV, whose corners of the first pixel's centre are at `origin_px`."""

    def begin(family: str, ids: Sequence[int]) -> Detect:
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = refinement
        bare = cv2.aruco.ArucoDetector(family_of(family).dictionary, parameters)

        def detect(_stamp_ns: int, pixels: Pixels) -> list[Marker]:
            corners, numbers, _rejected = bare.detectMarkers(pixels)
            found = np.zeros(0, dtype=int) if numbers is None else np.ravel(numbers)
            return [
                Marker(family, int(number), np.reshape(quad, (4, 2)).astype(np.float64) - origin_px)
                for number, quad in zip(found, corners, strict=True)
            ]

        return detect

    return Row(begin)


def _ours(*without: Replacement) -> Row:
    return Row(lambda family, ids: MarkerDetector({family: ids}).detect, without)


def _none_aligned(_pixels: Pixels, corners_px: Any, _patterns: Any) -> tuple[Any, list[float], list[None]]:
    return corners_px, [0.0] * len(corners_px), [None] * len(corners_px)


def _none_read(*_args: Any) -> list[Marker]:
    return []


def _no_squares(*_args: Any) -> Any:
    return np.zeros((0, 4, 2))


NOT_IN_PLACE: Replacement = (detector, "read_in_place", _none_read)
OURS = "ours"
ROWS: Mapping[str, Row] = {
    "OpenCV, no refinement": _opencv(cv2.aruco.CORNER_REFINE_NONE),
    "OpenCV, SUBPIX": _opencv(cv2.aruco.CORNER_REFINE_SUBPIX),
    "OpenCV, CONTOUR": _opencv(cv2.aruco.CORNER_REFINE_CONTOUR),
    "OpenCV, APRILTAG": _opencv(cv2.aruco.CORNER_REFINE_APRILTAG, origin_px=0.5),
    OURS: _ours(),
    "no alignment": _ours((decoding, "_aligned_if_small", _none_aligned)),
    "no in-place reading": _ours(NOT_IN_PLACE),
    "every image searched": _ours(NOT_IN_PLACE, (MarkerDetector, "_read_near", _none_read)),
    "no edge refinement": _ours((detector, "refine", lambda _pixels, corners_px: corners_px)),
    "no second look": _ours((detector, "rimmed_squares", _no_squares)),
    "no inner squares": _ours((detector, "inner_squares", _no_squares)),
    "no reading in shadow": _ours((decoding, "SHADOW_THRESHOLD", 0.5)),
    "no sharpening": _ours((decoding, "_sharpened", lambda levels: levels)),
}
