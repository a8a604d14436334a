"""Partly covered markers: a marker detected a moment ago is followed by its visible part."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum.arrays import Pixels
from actum.node import SECOND_NS
from marker_tracker.detection.alignment import align, align_by_similarity
from marker_tracker.detection.decoding import wrong_cells
from marker_tracker.detection.detector import SAME_PLACE_SIDES
from marker_tracker.detection.families import family
from marker_tracker.detection.marker import Key, Marker
from marker_tracker.occlusion.crop import scaled

Box = tuple[int, int, int, int]
"""Left, top, right and bottom in whole pixels, the last two exclusive."""

REMEMBERED_NS = SECOND_NS // 2
"""Nanoseconds for which a marker that is not detected is looked for."""
MAX_FOLLOWED = 4
"""Markers per image: each costs a millisecond or so."""
CELL_PX = 5.0
"""Largest cell in pixels: the image is scaled down for larger markers, whose alignment would not converge."""
QUIET_ZONE_CELLS = 1
"""White around a marker that belongs to its template, in cells: the printed white margin."""
SEARCH_RADIUS_SIDES = 0.4
"""Search radius around a marker's last position, in sides of the marker."""
SEARCH_SPEED_SIDES_PER_S = 8.0
"""Growth of the search radius for each second since the last view: an 8 cm marker at 0.6 m/s."""
MIN_CORRELATION = 0.5
"""Least normalised cross-correlation with the last view: a finger may cover half of the marker."""
TOUCHED_SHARE = 0.015
"""Covered share above the usual one from which a marker counts as touched, and keeps its last shape."""
USUAL_TIME_CONSTANT_S = 3.0
"""Time constant in seconds with which the usual covered share follows the present one."""
MIN_RIGHT_CELLS = 0.85
"""Least share of the code's cells that must be read correctly: by chance half of them are."""
MAX_COVERED = 0.2
"""Largest covered share of a followed marker: with a larger one the visible part does not determine the scale."""
MAX_GROWTH = 0.15
"""Largest relative change of a marker's side since its last view: no hand moves an object to the camera faster."""


@dataclass(frozen=True)
class LastView:
    """The last view of a marker, detected or followed.

    Attributes:
        marker: the marker.
        stamp_ns: of that image.
        usually_covered: smoothed covered share; blur and misprints count as covered, too.
        view: (height, width), grey levels of the marker with its white margin.
        scale: at most 1, by which the view is scaled to look for the marker.
    """

    marker: Marker
    stamp_ns: int
    usually_covered: float
    view: Pixels
    scale: float


class PartialOcclusionTracker:
    """Follows partly covered markers for half a second, keeping the shape of their last clear view."""

    def __init__(self) -> None:
        self._last: dict[Key, LastView] = {}

    def clear(self) -> None:
        """Forget where markers were."""
        self._last.clear()

    def update(self, stamp_ns: int, pixels: Pixels, detected: Sequence[Marker]) -> list[Marker]:
        """Add partly covered markers to those detected in a grey image (height, width).

        A detected marker that is touched is replaced by the followed one, if it can be followed: a finger that touches
        a marker shifts its detected corners.
        """
        self._last = {key: it for key, it in self._last.items() if stamp_ns - it.stamp_ns <= REMEMBERED_NS}
        clear = {marker.key for marker in detected if not self._is_touched(marker)}
        missing = [last for key, last in self._last.items() if key not in clear][:MAX_FOLLOWED]
        followed = [
            marker
            for last in missing
            if (marker := _follow(stamp_ns, pixels, last))
            and not any(
                each.key != marker.key
                and math.dist(each.centre_px, marker.centre_px) < SAME_PLACE_SIDES * marker.side_px
                for each in detected
            )
        ]
        replaced = {marker.key for marker in followed}
        markers = [*followed, *(marker for marker in detected if marker.key not in replaced)]
        for marker in markers:
            self._remember(stamp_ns, pixels, marker)
        return markers

    def _is_touched(self, marker: Marker) -> bool:
        last = self._last.get(marker.key)
        return last is not None and marker.covered > last.usually_covered + TOUCHED_SHARE

    def _remember(self, stamp_ns: int, pixels: Pixels, marker: Marker) -> None:
        """Keep a marker's view, unless it reaches the image's edge."""
        left, top, right, bottom = _box(marker, 0.0)
        if left < 0 or top < 0 or right > pixels.shape[1] or bottom > pixels.shape[0]:
            return
        scale = min(1.0, CELL_PX * (family(marker.family).cells + 2) / marker.side_px)
        usual = self._usually_covered(marker, stamp_ns)
        self._last[marker.key] = LastView(marker, stamp_ns, usual, pixels[top:bottom, left:right].copy(), scale)

    def _usually_covered(self, marker: Marker, stamp_ns: int) -> float:
        last = self._last.get(marker.key)
        if last is None:
            return marker.covered
        share = min(1.0, (stamp_ns - last.stamp_ns) / SECOND_NS / USUAL_TIME_CONSTANT_S)
        return last.usually_covered + share * (marker.covered - last.usually_covered)


def _follow(stamp_ns: int, pixels: Pixels, last: LastView) -> Marker | None:
    """Find a marker near its last place: roughly by template matching, then by alignment; None where it is lost."""
    marker, scale = last.marker, last.scale
    radius_sides = SEARCH_RADIUS_SIDES + SEARCH_SPEED_SIDES_PER_S * (stamp_ns - last.stamp_ns) / SECOND_NS
    left, top, right, bottom = _box(marker, radius_sides * marker.side_px)
    left, top = max(left, 0), max(top, 0)
    template = scaled(last.view, scale)
    window = scaled(pixels[top : max(bottom, top), left : max(right, left)], scale)
    if window.shape[0] < template.shape[0] or window.shape[1] < template.shape[1]:
        return None
    _, correlation, _, place_px = cv2.minMaxLoc(cv2.matchTemplate(window, template, cv2.TM_CCOEFF_NORMED))
    if not correlation >= MIN_CORRELATION:
        return None
    template_origin_px = np.array(_box(marker, 0.0)[:2])
    start_px = scale * (marker.corners_px - template_origin_px + 0.5) - 0.5 + place_px
    pattern = family(marker.family).patterns[marker.id]
    aligned = align_by_similarity(window, start_px[None], pattern[None])
    if aligned.covered[0] <= last.usually_covered + TOUCHED_SHARE:
        aligned = align(window, aligned.corners_px, pattern[None])
    wrong = wrong_cells(window, aligned.corners_px[0], pattern)
    corners_px = (aligned.corners_px[0] + 0.5) / scale - 0.5 + (left, top)
    moved = Marker(marker.family, marker.id, corners_px, int(wrong.sum()), float(aligned.covered[0]))
    is_visible = wrong[1:-1, 1:-1].mean() <= 1 - MIN_RIGHT_CELLS and moved.covered <= MAX_COVERED
    return moved if is_visible and abs(moved.side_px / marker.side_px - 1) <= MAX_GROWTH else None


def _box(marker: Marker, extra_px: float) -> Box:
    """Enclose a marker with its white margin and extra pixels on each side."""
    margin = QUIET_ZONE_CELLS * marker.side_px / (family(marker.family).cells + 2) + extra_px
    x, y = marker.corners_px.T.tolist()
    left, top = math.floor(min(x) - margin), math.floor(min(y) - margin)
    return left, top, math.ceil(max(x) + margin) + 1, math.ceil(max(y) + margin) + 1
