"""A person's stream through the first layer, and the pyramid vectors of any of its windows."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices
from actum_model_trainer.samples import LabelledStream
from som_classifier.handedness import LimbSpreads, limb_moments, mirrored
from som_classifier.kinematics import GAP_NS
from som_classifier.pyramid import Prefix, PrefixSums, quantised
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.windows import COVERED_SHARE, FEWEST_FRAMES

_UM_PER_M = 1e6


class EncodedStream:
    """The prefix sums of a stream's n frames, as seen and mirrored.

    Args:
        model: whose first layer and pyramid are used.
        stream: at least one frame.
    """

    def __init__(self, model: PyramidModel, stream: LabelledStream) -> None:
        self.stream = stream
        self.stamps_ns = stream.stamps_ns
        self._pyramid, self._mirrors = model.pyramid, model.metadata.mirrors
        sides = [(stream.postures, stream.velocities)]
        if self._mirrors:
            sides.append((mirrored(stream.postures), mirrored(stream.velocities)))
        summed = [_sums(quantised(model.first.activities(*side))) for side in sides]
        steps_um = np.rint(stream.motion.sum(axis=1) * _UM_PER_M).astype(np.int64)
        travelled_um = [0, *np.cumsum(steps_um).tolist()]
        self._prefixes = [
            Prefix(tuple(sums), um) for *sums, um in zip(*summed, travelled_um, strict=True)
        ]  # fmt: skip
        moments = np.array([limb_moments(posture) for posture in stream.postures])
        self._moments = np.concatenate([np.zeros_like(moments[:1]), np.cumsum(moments, axis=0)])

    def vector(self, first: int, last: int) -> NDArray[np.float32]:
        """Return the pyramid vector of the frames from `first` to `last`, both included, (inputs,)."""
        limbs = self._moments[last + 1] - self._moments[first]
        side = int(self._mirrors and LimbSpreads.of(limbs).left_handed)
        return self._pyramid.vector(PrefixSums(self._prefixes[first : last + 2], side))

    def frames_within(self, start_ns: float, end_ns: float) -> tuple[int, int]:
        """Return the first and the last frame of a span; the last is before the first where it holds none."""
        first = int(np.searchsorted(self.stamps_ns, start_ns))
        return first, int(np.searchsorted(self.stamps_ns, end_ns, side="right")) - 1

    @cached_property
    def run_starts(self) -> Indices:
        """For each frame, the first one since the last gap, shape (n,)."""
        gaps = np.flatnonzero(np.diff(self.stamps_ns) > GAP_NS) + 1
        starts = np.zeros(len(self.stamps_ns), dtype=np.intp)
        starts[gaps] = gaps
        return np.maximum.accumulate(starts)

    def live_windows(self, durations_ns: Indices, interval_ns: int) -> Indices:
        """Return first and last frame of all windows that a live search looks at, in order, shape (windows, 2).

        Args:
            durations_ns: of the windows, rising.
            interval_ns: between two decisions.
        """
        found, next_ns = [], int(self.stamps_ns[0])
        for last, now_ns in enumerate(self.stamps_ns.tolist()):
            if self.run_starts[last] == last:
                next_ns = now_ns
            if now_ns < next_ns:
                continue
            next_ns = now_ns + interval_ns
            firsts = np.maximum(np.searchsorted(self.stamps_ns, now_ns - durations_ns), self.run_starts[last])
            enough = (now_ns - self.stamps_ns[firsts] >= COVERED_SHARE * durations_ns) & (
                last - firsts + 1 >= FEWEST_FRAMES
            )
            found += [(first, last) for first in firsts[enough].tolist()]
        return np.array(found, dtype=np.intp).reshape(-1, 2)


def _sums(activities: NDArray[np.uint32]) -> NDArray[np.uint32]:
    sums = np.zeros((len(activities) + 1, activities.shape[1]), np.uint32)
    np.cumsum(activities, axis=0, out=sums[1:])
    return sums
