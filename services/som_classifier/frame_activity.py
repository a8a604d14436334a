"""The activity of the default recogniser's first layer at each frame, kept as prefix sums.

A sum over a segment is the difference of two prefix sums, so that its cost does not grow with the segment's length.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import JOINTS
from som_classifier.attention import PART_NAMES
from som_classifier.first_layer import FirstMaps
from som_classifier.frames import Frame
from som_classifier.handedness import LIMBS, MOMENTS, LimbSpreads, limb_moments, mirrored
from som_classifier.pyramid import Prefix, PrefixSums, Sums, quantised

Totals = NDArray[np.int64]
"""Prefix sums of whole numbers: the displacement of each part (5; µm), the moments of the limbs (4 * 8), the number of
missing joints (1), the logarithm of the posture map's quantization error as seen and mirrored (2; millionths)."""

_PARTS = slice(0, len(PART_NAMES))
_LIMBS = slice(_PARTS.stop, _PARTS.stop + LIMBS * MOMENTS)
_MISSING = _LIMBS.stop
_LOG_ERRORS = slice(_MISSING + 1, _MISSING + 3)
UM_PER_M = 1e6
"""Micrometres in a metre: displacements are added up in whole ones."""
_MILLIONTHS = 1e6
"""Steps per unit in which logarithms are added up."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameActivity:
    """The prefix sums before and after a frame, and its winners on the posture map.

    Attributes:
        before: sums of activities over all earlier frames, of the actor as seen and mirrored.
        after: the same with this frame.
        totals_before: the other sums over all earlier frames.
        totals_after: the same with this frame.
        winners: the posture map's winner for the actor as seen and mirrored.
    """

    before: Prefix
    after: Prefix
    totals_before: Totals
    totals_after: Totals
    winners: tuple[int, int]


class FrameEncoder:
    """Adds up one agent's activities frame by frame, of the actor as seen and mirrored."""

    def __init__(self, first: FirstMaps) -> None:
        self._first = first
        self._sums: Sums = np.zeros((2, first.units), np.uint32)
        self._prefix = Prefix(tuple(self._sums), 0)
        self._totals: Totals = np.zeros(_LOG_ERRORS.stop, np.int64)

    def encode(self, frame: Frame) -> FrameActivity:
        """Add a valid frame and return its activity."""
        assert frame.kinematics is not None and frame.motion is not None
        posture = frame.kinematics.posture
        activities = self._first.frame_activities(posture, frame.kinematics.velocity)
        winner, mirror_winner = activities[:, : len(self._first.postures.weights)].argmax(axis=1).tolist()
        log_errors = self._first.log_errors(np.stack([posture, mirrored(posture)]), [winner, mirror_winner])
        moved_um = np.rint(frame.motion * UM_PER_M).astype(np.int64)
        before, totals_before = self._prefix, self._totals
        self._sums = self._sums + quantised(activities)
        self._prefix = Prefix(tuple(self._sums), before.travelled_um + sum(moved_um.tolist()))
        self._totals = totals_before.copy()
        self._totals[_PARTS] += moved_um
        self._totals[_LIMBS] += limb_moments(posture).ravel()
        self._totals[_MISSING] += len(frame.missing)
        self._totals[_LOG_ERRORS] += np.rint(log_errors * _MILLIONTHS).astype(np.int64)
        return FrameActivity(before, self._prefix, totals_before, self._totals, (winner, mirror_winner))


def segment_sums(frames: Sequence[FrameActivity], in_mirror: bool) -> PrefixSums:
    """Return a segment's prefix sums of activity, of the actor as seen or mirrored."""
    return PrefixSums([frames[0].before, *[frame.after for frame in frames]], int(in_mirror))


def left_handed(frames: Sequence[FrameActivity]) -> bool:
    """Tell whether the left arm acts."""
    limbs = (frames[-1].totals_after - frames[0].totals_before)[_LIMBS].reshape(LIMBS, MOMENTS)
    return LimbSpreads.of(limbs).left_handed


def most_moved_part(frames: Sequence[FrameActivity]) -> str:
    """Name the part that moves most; the first frame's displacement is from before the segment and not counted."""
    return PART_NAMES[int((frames[-1].totals_after - frames[0].totals_after)[_PARTS].argmax())]


def known_joint_share(frames: Sequence[FrameActivity]) -> float:
    """Return the share of joints that are known, over all frames."""
    missing = frames[-1].totals_after[_MISSING] - frames[0].totals_before[_MISSING]
    return 1.0 - int(missing) / (len(JOINTS) * len(frames))


def mean_log_error(frames: Sequence[FrameActivity], in_mirror: bool) -> float:
    """Return the mean logarithm of the posture map's squared quantization error (m²) over all frames."""
    summed = (frames[-1].totals_after - frames[0].totals_before)[_LOG_ERRORS]
    return int(summed[int(in_mirror)]) / (_MILLIONTHS * len(frames))
