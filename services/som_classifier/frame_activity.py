"""The activity of the default recogniser's first layer at each frame, kept as prefix sums.

A sum over a segment is the difference of two prefix sums, so that its cost does not grow with the segment's length.
"""

from collections.abc import Sequence
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.core import steps
from actum.skeletons import JOINTS
from som_classifier.attention import PART_NAMES
from som_classifier.first_layer import MIRRORED, SMALLEST_ERROR2, FirstMaps
from som_classifier.frames import Frame
from som_classifier.handedness import COMPONENTS, LIMBS, MOMENTS, left_arm_acts, limb_moments, mirrored
from som_classifier.kinematics import Kinematics
from som_classifier.pyramid import MOST_FRAMES, SCALE, Prefix, PrefixSums, Pyramid, Sums, quantised

Totals = NDArray[np.int64]
"""Prefix sums of whole numbers: the displacement of each part (5; µm), the moments of the limbs (4 * 8), the number of
missing joints (1), the logarithm of the posture map's quantization error as seen and mirrored (2; millionths)."""

_PARTS = slice(0, len(PART_NAMES))
_LIMBS = slice(_PARTS.stop, _PARTS.stop + LIMBS * MOMENTS)
_MISSING = _LIMBS.stop
_LOG_ERRORS = slice(_MISSING + 1, _MISSING + 3)
_LIMB_COMPONENTS = COMPONENTS.astype(np.int32).tobytes()
UM_PER_M = 1e6
"""Micrometres in a metre: displacements are added up in whole ones."""
_MILLIONTHS = 1e6
"""Steps per unit in which logarithms are added up."""


class FrameActivity(NamedTuple):
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
        before, totals_before = self._prefix, self._totals
        if steps is None or frame.missing or self._first.postures.dtype != np.float32:
            *winners, moved_um = self._add(frame, frame.kinematics, frame.motion)
        else:
            *winners, moved_um = self._add_compiled(steps, frame.kinematics, frame.motion)
        self._prefix = Prefix((self._sums[0], self._sums[1]), before.travelled_um + moved_um)
        return FrameActivity(before, self._prefix, totals_before, self._totals, (winners[0], winners[1]))

    def _add(self, frame: Frame, kinematics: Kinematics, motion: Array) -> tuple[int, int, int]:
        """Add a frame to the sums; return its winners on the posture map, as seen and mirrored, and how far it moved.

        That is the sum of the displacements of all parts, in micrometres.
        """
        posture = kinematics.posture
        activities = self._first.frame_activities(posture, kinematics.velocity)
        winners: list[int] = activities[:, : len(self._first.postures.weights)].argmax(axis=1).tolist()
        log_errors = self._first.log_errors(np.stack([posture, mirrored(posture)]), winners)
        self._sums = self._sums + quantised(activities)
        moved_um = np.rint(motion * UM_PER_M)
        added = moved_um, limb_moments(posture).ravel(), [len(frame.missing)], np.rint(log_errors * _MILLIONTHS)
        self._totals = self._totals + np.concatenate(added).astype(np.int64)
        return winners[0], winners[1], int(moved_um.sum())

    def _add_compiled(self, steps: ModuleType, kinematics: Kinematics, motion: Array) -> tuple[int, int, int]:
        """Add a frame whose joints are all known, by compiled steps; return the same as `_add`."""
        posture, velocity = np.ascontiguousarray(kinematics.posture), np.ascontiguousarray(kinematics.velocity)
        before, totals_before = self._sums, self._totals
        activities = self._first.unnormalised_activities(steps, posture, velocity)
        self._sums, self._totals = np.empty_like(before), np.empty_like(totals_before)
        added: tuple[int, int, int] = steps.added(
            activities, self._first.shares, SCALE, before, self._sums, np.ascontiguousarray(motion), posture, *MIRRORED,
            self._first.posture_weights, _LIMB_COMPONENTS, SMALLEST_ERROR2, totals_before, self._totals,
        )  # fmt: skip
        return added


def segment_sums(frames: Sequence[FrameActivity], in_mirror: bool) -> PrefixSums:
    """Return a segment's prefix sums of activity, of the actor as seen or mirrored."""
    prefixes, side = [frames[0].before, *[frame.after for frame in frames]], int(in_mirror)
    return PrefixSums([at.sums[side] for at in prefixes], np.array([at.travelled_um for at in prefixes]))


def pooled_windows(
    pyramid: Pyramid, frames: list[FrameActivity], firsts: Sequence[int], in_mirror: Sequence[bool]
) -> list[NDArray[np.float32]]:
    """Return the pyramid vectors (inputs,) of windows that end with the last frame.

    Args:
        pyramid: by which they are pooled.
        frames: of the longest window.
        firsts: the index of each window's first frame.
        in_mirror: whether each window is read as its mirror image.
    """
    if steps is None or len(frames) > MOST_FRAMES:
        sums = {side: segment_sums(frames, side) for side in set(in_mirror)}
        windows = [sums[side].between(first, len(frames)) for side, first in zip(in_mirror, firsts, strict=True)]
        return list(map(pyramid.vector, windows))
    vectors = np.empty((len(firsts), pyramid.cells * len(frames[0].before.sums[0])), np.float32)
    steps.pooled_windows(frames, list(firsts), list(in_mirror), *pyramid.compiled, SCALE, vectors)
    return list(vectors)


def left_handed(frames: Sequence[FrameActivity]) -> bool:
    """Tell whether the left arm acts over a segment, of which only the first and the last frame matter."""
    return left_arm_acts(frames[0].totals_before, frames[-1].totals_after, _LIMBS.start)


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
