"""Collects views from a live stream in which the board is held still and differs enough from earlier views."""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum_calibrator.board_views import View
from actum_calibrator.pairs import Pair
from actum_calibrator.view_set import (
    CELLS,
    FEWEST_TILTED,
    GOOD_COVERAGE,
    TILT_DEG,
    covered_cells,
    nominal_tilts_deg,
    shortcomings,
)

STILL_OF_DIAGONAL = 0.003  # share of the image's diagonal between two images: 2.4 px in 640x480, a hand's tremor
NEW_OF_DIAGONAL = 0.08  # share of the image's diagonal: views nearer to each other add little information
ENOUGH_VIEWS = 15  # with more, the standard deviations hardly shrink if the image is covered
MOST_VIEWS = 40  # more take long to compute and add little information
TILTED_SHARE = 0.5  # share of the views: frontal ones determine the distortion, tilted ones the focal length
ENOUGH_PAIRS = 8  # within the recommended 6 to 10
ROWS = ("top", "middle", "bottom")
COLUMNS = ("left", "centre", "right")


class Stillness:
    """Judges whether the board rests: its outline has moved by at most 0.3 % of the diagonal since the last picture."""

    def __init__(self) -> None:
        self._last_px: Array | None = None

    def judge(self, view: View | None) -> bool:
        """Judge the next picture's view, None if no board was found; return whether the board rests."""
        last_px, self._last_px = self._last_px, None if view is None else view.outline_px()
        if view is None or last_px is None or self._last_px is None:
            return False
        return _moved_px(last_px, self._last_px) <= STILL_OF_DIAGONAL * view.diagonal_px


class ViewCollector:
    """Collects views of one camera until they suffice for calibration."""

    def __init__(self) -> None:
        self.views: list[View] = []
        self._stillness = Stillness()

    def offer(self, view: View | None) -> bool:
        """Offer the next picture's view, None if no board was found; return whether it was kept."""
        if not self._stillness.judge(view) or view is None or not is_new(view, self.views):
            return False
        self.views.append(view)
        return True

    @property
    def complete(self) -> bool:
        """Whether there is no instruction left, or the largest number of views is reached."""
        return self.instruction is None or len(self.views) >= MOST_VIEWS

    @property
    def instruction(self) -> str | None:
        """How to show the board next; None if the views suffice."""
        if not self.views:
            return "show the board and hold it still for a moment"
        tilted = sum(tilt >= TILT_DEG for tilt in nominal_tilts_deg(self.views))
        if tilted < max(FEWEST_TILTED, TILTED_SHARE * len(self.views)):
            return "tilt the board by about 30 deg, left, right, up or down"
        covered = covered_cells(self.views)
        if covered.mean() < GOOD_COVERAGE:
            rows = np.array_split(np.arange(CELLS[1]), 3)
            columns = np.array_split(np.arange(CELLS[0]), 3)
            share = [[covered[np.ix_(down, across)].mean() for across in columns] for down in rows]
            row, column = divmod(int(np.argmin(share)), 3)
            return f"show the board at the {ROWS[row]} {COLUMNS[column]} of the image, tilted"
        if len(self.views) < ENOUGH_VIEWS or shortcomings(self.views):
            return "show the board tilted another way, closer or further away"
        return None


class PairCollector:
    """Collects pairs of views of two cameras, taken while the board rests in both images."""

    def __init__(self) -> None:
        self.pairs: list[Pair] = []
        self._stillness = (Stillness(), Stillness())
        self._resting: list[View | None] = [None, None]

    def offer(self, camera: int, view: View | None) -> bool:
        """Offer the next view of camera 0 (sees markers) or 1 (sees people); return whether a pair was kept."""
        resting = self._stillness[camera].judge(view)
        self._resting[camera] = view if resting else None
        if not resting:
            self._resting[1 - camera] = None
        markers, people = self._resting
        if markers is None or people is None or not is_new(markers, [pair.markers for pair in self.pairs]):
            return False
        self.pairs.append(Pair(f"pair {len(self.pairs) + 1}", markers, people))
        return True

    @property
    def complete(self) -> bool:
        """Whether there are enough pairs."""
        return len(self.pairs) >= ENOUGH_PAIRS


def is_new(view: View, taken: Sequence[View]) -> bool:
    """Whether, compared with each taken view, some outer corner of the board has moved by over 8 % of the diagonal."""
    least_px = NEW_OF_DIAGONAL * view.diagonal_px
    return all(_moved_px(view.outline_px(), other.outline_px()) > least_px for other in taken)


def _moved_px(one_px: Array, other_px: Array) -> float:
    """Return the largest motion of the board's outer corners (4, 2) between two views."""
    return float(np.linalg.norm(one_px - other_px, axis=1).max())
