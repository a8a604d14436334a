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
from som_classifier.handedness import ARMS, COMPONENTS, LIMBS, MOMENTS, left_arm_acts, limb_moments, mirrored
from som_classifier.kinematics import Kinematics
from som_classifier.pyramid import MOST_FRAMES, SCALE, PrefixSums, Pyramid, Sums, quantised

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


ROWS = 33
"""Rows of sums in one array: more would keep longer what nobody needs any more, fewer would repeat more of them."""


class Run(NamedTuple):
    """Sums over all frames up to some instants, one after the other.

    Attributes:
        sums: (instants, 2, units), of quantised activities modulo 2³², of the actor as seen and mirrored.
        totals: (instants, totals), the other sums.
    """

    sums: Sums
    totals: Totals

    @classmethod
    def beginning(cls, sums: Sums, totals: Totals) -> "Run":
        """Return a run with room for `ROWS` instants, of which the first has these sums."""
        run = cls(np.empty((ROWS, *sums.shape), sums.dtype), np.empty((ROWS, *totals.shape), totals.dtype))
        run.sums[0], run.totals[0] = sums, totals
        return run


class FrameActivity(NamedTuple):
    """The sums before and after a frame, and its winners on the posture map.

    Attributes:
        run: holds the sums.
        row: of the instant before the frame; that after it is the next.
        winners: the posture map's winner for the actor as seen and mirrored.
    """

    run: Run
    row: int
    winners: tuple[int, int]

    @property
    def before(self) -> Sums:
        """The sums of activities over all earlier frames, (2, units)."""
        before: Sums = self.run.sums[self.row]
        return before

    @property
    def after(self) -> Sums:
        """The same with this frame."""
        after: Sums = self.run.sums[self.row + 1]
        return after

    @property
    def totals_before(self) -> Totals:
        """The other sums over all earlier frames."""
        before: Totals = self.run.totals[self.row]
        return before

    @property
    def totals_after(self) -> Totals:
        """The same with this frame."""
        after: Totals = self.run.totals[self.row + 1]
        return after


class FrameEncoder:
    """Adds up one agent's activities frame by frame, of the actor as seen and mirrored."""

    def __init__(self, first: FirstMaps) -> None:
        self._first = first
        self._run = Run.beginning(np.zeros((2, first.units), np.uint32), np.zeros(_LOG_ERRORS.stop, np.int64))
        self._row = 0

    def encode(self, frame: Frame) -> FrameActivity:
        """Add a valid frame and return its activity."""
        assert frame.kinematics is not None and frame.motion is not None
        if self._row == ROWS - 1:
            self._run, self._row = Run.beginning(self._run.sums[-1], self._run.totals[-1]), 0
        if steps is None or frame.missing or self._first.postures.dtype != np.float32:
            winners = self._add(frame, frame.kinematics, frame.motion)
        else:
            winners = self._add_compiled(steps, frame.kinematics, frame.motion)
        self._row += 1
        return FrameActivity(self._run, self._row - 1, winners)

    def _add(self, frame: Frame, kinematics: Kinematics, motion: Array) -> tuple[int, int]:
        """Write the sums with a frame; return its winners on the posture map, as seen and mirrored."""
        posture, (sums, totals), row = kinematics.posture, self._run, self._row
        activities = self._first.frame_activities(posture, kinematics.velocity)
        winners: list[int] = activities[:, : len(self._first.postures.weights)].argmax(axis=1).tolist()
        log_errors = self._first.log_errors(np.array([posture, mirrored(posture)]), winners)
        np.add(sums[row], quantised(activities), out=sums[row + 1])
        added = np.rint(motion * UM_PER_M), limb_moments(posture).ravel(), [len(frame.missing)]
        in_all = np.concatenate([*added, np.rint(log_errors * _MILLIONTHS)]).astype(np.int64)
        np.add(totals[row], in_all, out=totals[row + 1])
        return winners[0], winners[1]

    def _add_compiled(self, steps: ModuleType, kinematics: Kinematics, motion: Array) -> tuple[int, int]:
        """Write the sums with a frame whose joints are all known, by compiled steps; return the same as `_add`."""
        posture, velocity = np.ascontiguousarray(kinematics.posture), np.ascontiguousarray(kinematics.velocity)
        activities = self._first.unnormalised_activities(steps, posture, velocity)
        winners: tuple[int, int] = steps.added(
            activities, self._first.shares, SCALE, np.ascontiguousarray(motion), posture, *MIRRORED,
            self._first.posture_weights, _LIMB_COMPONENTS, SMALLEST_ERROR2, *self._run, self._row,
        )  # fmt: skip
        return winners


def segment_sums(frames: Sequence[FrameActivity], in_mirror: bool) -> PrefixSums:
    """Return a segment's prefix sums of activity, of the actor as seen or mirrored."""
    side, totals, first = int(in_mirror), [frames[0].totals_before[None]], 0
    while first < len(frames):
        run, row, _ = frames[first]
        totals.append(run.totals[row + 1 :][: len(frames) - first])  # a run's frames follow one another to its end
        first += len(totals[-1])
    travelled_um: NDArray[np.int64] = np.concatenate(totals)[:, _PARTS].sum(axis=1)
    return PrefixSums([frames[0].before[side], *[run.sums[row + 1, side] for run, row, _ in frames]], travelled_um)


def pooled_windows(
    pyramid: Pyramid, frames: list[FrameActivity], firsts: Sequence[int], mirrors: bool
) -> NDArray[np.float32]:
    """Return the pyramid vectors of windows that end with the last frame, (windows, inputs).

    Args:
        pyramid: by which they are pooled.
        frames: of the longest window.
        firsts: the index of each window's first frame.
        mirrors: whether windows in which the left arm acts are read as their mirror image.
    """
    vectors = np.empty((len(firsts), pyramid.cells * frames[0].before.shape[1]), np.float32)
    if steps is not None and len(frames) <= MOST_FRAMES:
        steps.pooled_windows(frames, list(firsts), mirrors, *ARMS, *pyramid.compiled, SCALE, vectors)
        return vectors
    in_mirror = [mirrors and left_handed((frames[first], frames[-1])) for first in firsts]
    sums = {side: segment_sums(frames, side) for side in set(in_mirror)}
    for vector, side, first in zip(vectors, in_mirror, firsts, strict=True):
        vector[:] = pyramid.vector(sums[side].between(first, len(frames)))
    return vectors


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
