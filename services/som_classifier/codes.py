"""What the default recogniser remembers of each frame: running totals, of which any segment's are a difference."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import JOINTS
from som_classifier.attention import PART_NAMES
from som_classifier.handedness import LIMBS, MOMENTS, Spreads, mirrored, moments
from som_classifier.layers import FirstMaps
from som_classifier.pyramid import Instant, Sums, Trail, quantised
from som_classifier.streams import Frame

Totals = NDArray[np.int64]
"""Whole numbers: how far each part has moved (5; micrometres), the moments of the limbs (4 * 8), missing joints, and
the logarithm of the posture map's quantization error as seen and in a mirror (2; millionths)."""

_PARTS = slice(0, len(PART_NAMES))
_LIMBS = slice(_PARTS.stop, _PARTS.stop + LIMBS * MOMENTS)
_MISSING = _LIMBS.stop
_LOG_ERRORS = slice(_MISSING + 1, _MISSING + 3)
_UM_PER_M = 1e6
_MILLIONTHS = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class Code:
    """One frame: the running totals before and after it, and the posture map's winners.

    The sums of activities and the winners are of the actor as seen and in a mirror.
    """

    before: Instant
    after: Instant
    totals_before: Totals
    totals: Totals
    winners: tuple[int, int]


class FrameEncoder:
    """Adds up one agent's activities, frame by frame, as seen and in a mirror."""

    def __init__(self, first: FirstMaps) -> None:
        self._first = first
        self._sums: Sums = np.zeros((2, first.units), np.uint32)
        self._instant = Instant(tuple(self._sums), 0)
        self._totals: Totals = np.zeros(_LOG_ERRORS.stop, np.int64)

    def encode(self, frame: Frame) -> Code:
        """Add a valid frame."""
        assert frame.movement is not None and frame.motion is not None
        sides = self._first.sides(frame.movement.posture, frame.movement.velocity)
        moved_um = np.rint(frame.motion * _UM_PER_M).astype(np.int64)
        before, totals_before = self._instant, self._totals
        self._sums = self._sums + quantised(sides)
        self._instant = Instant(tuple(self._sums), before.travelled_um + sum(moved_um.tolist()))
        self._totals = totals_before.copy()
        self._totals[_PARTS] += moved_um
        self._totals[_LIMBS] += moments(frame.movement.posture).ravel()
        self._totals[_MISSING] += len(frame.missing)
        seen, in_mirror = sides[:, : len(self._first.postures.weights)].argmax(axis=1).tolist()
        both = np.stack([frame.movement.posture, mirrored(frame.movement.posture)])
        log_errors = self._first.log_errors(both, [seen, in_mirror])
        self._totals[_LOG_ERRORS] += np.rint(log_errors * _MILLIONTHS).astype(np.int64)
        return Code(before, self._instant, totals_before, self._totals, (seen, in_mirror))


def trail_of(codes: Sequence[Code], in_mirror: bool) -> Trail:
    """Return a segment's running sums."""
    return Trail([codes[0].before, *[code.after for code in codes]], int(in_mirror))


def left_handed(codes: Sequence[Code]) -> bool:
    """Tell whether the left arm acts."""
    limbs = (codes[-1].totals - codes[0].totals_before)[_LIMBS].reshape(LIMBS, MOMENTS)
    return Spreads.of(limbs).left_handed


def most_moved_part(codes: Sequence[Code]) -> str:
    """Name the part that moves most; motion before the segment, which the first frame carries, does not count."""
    return PART_NAMES[int((codes[-1].totals - codes[0].totals)[_PARTS].argmax())]


def seen_share(codes: Sequence[Code]) -> float:
    """Return which share of the joints was there over all frames."""
    missing = codes[-1].totals[_MISSING] - codes[0].totals_before[_MISSING]
    return 1.0 - int(missing) / (len(JOINTS) * len(codes))


def mean_log_error(codes: Sequence[Code], in_mirror: bool) -> float:
    """Return the mean logarithm of the posture map's squared quantization error over all frames."""
    summed = (codes[-1].totals - codes[0].totals_before)[_LOG_ERRORS]
    return int(summed[int(in_mirror)]) / (_MILLIONTHS * len(codes))
