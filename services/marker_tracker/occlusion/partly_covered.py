"""Markers that a finger lies on: what was found a moment ago and is covered in part is followed by what still shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from marker_tracker.detection import reading
from marker_tracker.detection.alignment import aligned, aligned_alike
from marker_tracker.detection.decoding import Marker
from marker_tracker.detection.detector import SAME_PLACE
from marker_tracker.detection.families import family
from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]
Box = tuple[int, int, int, int]

REMEMBERED_NS = SECOND_NS // 2
MOST_FOLLOWED = 4
CELL_PX = 5.0
"""Markers with larger cells are followed in a smaller image: their edges lie too far apart to pull on each other."""
QUIET_CELLS = 1
NEAR_SIDES, SIDES_PER_S = 0.4, 8.0
"""How far a marker may have gone since it was seen, in sides of it: 8 cm at 0.6 m/s."""
ALIKE = 0.5
"""Correlation with how it looked before from which its new place is believed."""
TOUCHED = 0.015
"""How much more of a marker than usual is covered where its shape is taken from before."""
USUAL_S = 3.0
"""What covers a marker for long is usual: time constant."""
SHOWING = 0.85
"""Part of the cells of its code that have to be right: half of them are so by chance."""
MOST_COVERED = 0.2
"""Part of a marker that may be covered: what shows of it tells its size no longer where more is."""
GROWTH = 0.15
"""Most that a side may grow or shrink from one image to the next."""


@dataclass(frozen=True)
class Known:
    """A marker where it was last, and how it looked there: `patch` is around it, scaled by `scale`.

    `usual` is the part of it that has been covered for some time, or that only seems so: blurred, or misprinted.
    """

    marker: Marker
    seen_ns: int
    usual: float
    patch: Pixels
    scale: float


class Follower:
    """Remembers for half a second where markers were, and finds again what is covered, in the shape it had."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], Known] = {}

    def clear(self) -> None:
        """Forget everything: the source has started anew."""
        self._known.clear()

    def followed(self, stamp_ns: int, pixels: Pixels, found: Sequence[Marker]) -> list[Marker]:
        """Add to what is found what was there a moment ago; take the shape of what is touched from before."""
        self._known = {key: it for key, it in self._known.items() if stamp_ns - it.seen_ns <= REMEMBERED_NS}
        clear = {(marker.family, marker.id) for marker in found if not self._is_touched(marker)}
        missing = [known for key, known in self._known.items() if key not in clear][:MOST_FOLLOWED]
        again = [
            marker for known in missing if (marker := _again(stamp_ns, pixels, known)) and not _taken(marker, found)
        ]
        replaced = {(marker.family, marker.id) for marker in again}
        kept = [marker for marker in found if (marker.family, marker.id) not in replaced]
        for marker in (*again, *kept):
            self._remember(stamp_ns, pixels, marker)
        return [*again, *kept]

    def _is_touched(self, marker: Marker) -> bool:
        known = self._known.get((marker.family, marker.id))
        return known is not None and marker.covered > known.usual + TOUCHED

    def _remember(self, stamp_ns: int, pixels: Pixels, marker: Marker) -> None:
        """Note how a marker looks; not at the image's edge."""
        left, top, right, bottom = _box(marker, 0.0)
        if left < 0 or top < 0 or right > pixels.shape[1] or bottom > pixels.shape[0]:
            return
        scale = min(1.0, CELL_PX * (family(marker.family).cells + 2) / marker.side_px)
        patch = _scaled(pixels[top:bottom, left:right], scale)
        self._known[marker.family, marker.id] = Known(marker, stamp_ns, self._usual(marker, stamp_ns), patch, scale)

    def _usual(self, marker: Marker, stamp_ns: int) -> float:
        known = self._known.get((marker.family, marker.id))
        if known is None:
            return marker.covered
        passed = min(1.0, (stamp_ns - known.seen_ns) / SECOND_NS / USUAL_S)
        return known.usual + passed * (marker.covered - known.usual)


def _again(stamp_ns: int, pixels: Pixels, known: Known) -> Marker | None:
    """Find a marker near where it was."""
    marker, scale = known.marker, known.scale
    sides = NEAR_SIDES + SIDES_PER_S * (stamp_ns - known.seen_ns) / SECOND_NS
    left, top, right, bottom = _box(marker, sides * marker.side_px)
    left, top = max(left, 0), max(top, 0)
    window = _scaled(pixels[top : max(bottom, top), left : max(right, left)], scale)
    if window.shape[0] < known.patch.shape[0] or window.shape[1] < known.patch.shape[1]:
        return None
    _, alike, _, (x, y) = cv2.minMaxLoc(cv2.matchTemplate(window, known.patch, cv2.TM_CCOEFF_NORMED))
    if not alike >= ALIKE:
        return None
    corner = np.array(_box(marker, 0.0)[:2])
    start = scale * (marker.corners_px - corner + 0.5) - 0.5 + (x, y)
    shown = family(marker.family).shown[marker.id]
    exact = aligned_alike(window, start[None], shown[None])
    if exact.covered[0] <= known.usual + TOUCHED:
        exact = aligned(window, exact.corners_px, shown[None])
    wrong = reading.read(window, exact.corners_px, len(shown) - 2)[0] != shown
    corners_px = (exact.corners_px[0] + 0.5) / scale - 0.5 + (left, top)
    moved = Marker(marker.family, marker.id, corners_px, int(wrong.sum()), float(exact.covered[0]))
    shows = wrong[1:-1, 1:-1].mean() <= 1 - SHOWING and moved.covered <= MOST_COVERED
    return moved if shows and _is_as_large(moved, marker) else None


def _taken(marker: Marker, found: Sequence[Marker]) -> bool:
    """Tell whether another marker is found in a marker's place."""
    return any(
        (one.family, one.id) != (marker.family, marker.id)
        and math.dist(one.centre_px, marker.centre_px) < SAME_PLACE * marker.side_px
        for one in found
    )


def _is_as_large(marker: Marker, before: Marker) -> bool:
    return abs(marker.side_px / before.side_px - 1) <= GROWTH


def _box(marker: Marker, more_px: float) -> Box:
    """Enclose a marker with its white: left, top, right, bottom in whole pixels."""
    margin = QUIET_CELLS * marker.side_px / (family(marker.family).cells + 2) + more_px
    low = np.floor(marker.corners_px.min(axis=0) - margin).astype(int).tolist()
    high = np.ceil(marker.corners_px.max(axis=0) + margin).astype(int).tolist()
    return low[0], low[1], high[0] + 1, high[1] + 1


def _scaled(pixels: Pixels, scale: float) -> Pixels:
    if scale == 1.0:
        return pixels
    if scale * min(pixels.shape) < 1:
        return pixels[:0, :0]
    return np.asarray(cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), dtype=np.uint8)
