"""A person's stream through the first layer, as far as windows of it need it, and the windows' pyramid vectors."""

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices, Mask
from actum_model_trainer.augmentation import Variant
from actum_model_trainer.pooling import summed_activities
from actum_model_trainer.samples import LabelledStream
from som_classifier.frame_activity import UM_PER_M
from som_classifier.handedness import left_handed, limb_moments
from som_classifier.pyramid import PrefixSums, Pyramid
from som_classifier.pyramid_model import PyramidModel


class EncodedStream:
    """Windows of a stream, and the sums of the activity that they are pooled from.

    Args:
        model: whose first layer and pyramid are used.
        stream: at least one frame.
        windows: (n, 2), first and last frame of each.
        variant: the stream's frames as measured or augmented; as measured unless given.
    """

    def __init__(
        self, model: PyramidModel, stream: LabelledStream, windows: Indices, variant: Variant | None = None
    ) -> None:
        seen = variant or Variant((stream.postures, stream.velocities))
        in_mirror = _read_in_mirror(model, stream, windows)
        self._in_mirror = in_mirror
        self._sides = {
            side: _Side(model, stream, windows[in_mirror == side], seen.mirrored if side else seen)
            for side in np.unique(in_mirror).tolist()
        }

    def pool(self, first: int, after: int, out: NDArray[np.float32]) -> None:
        """Write the pyramid vectors of the windows from number `first` up to the one before `after`, (k, inputs)."""
        if len(self._sides) == 1:
            (side,) = self._sides.values()
            side.pool(first, after, out)
            return
        for number, side in self._sides.items():
            of_side = self._in_mirror == number
            before, own = int(np.count_nonzero(of_side[:first])), np.flatnonzero(of_side[first:after])
            vectors = np.empty((len(own), out.shape[1]), np.float32)
            side.pool(before, before + len(own), vectors)
            out[own] = vectors


class _Side:
    """Windows that are all read as seen, or all as the mirror image, with the sums over the frames in them alone."""

    def __init__(self, model: PyramidModel, stream: LabelledStream, windows: Indices, variant: Variant) -> None:
        needed = _frames_in(windows, len(stream.stamps_ns))
        place = np.concatenate([[0], np.cumsum(needed)])
        steps_um = np.rint(stream.motion[needed] * UM_PER_M).astype(np.int64).sum(axis=1)
        travelled_um = np.concatenate([[0], np.cumsum(steps_um)])
        self._pyramid: Pyramid = model.pyramid
        self._run = PrefixSums(summed_activities(model.first, variant.some(needed)), travelled_um)
        self._spans = np.stack([place[windows[:, 0]], place[windows[:, 1] + 1]], axis=1)

    def pool(self, first: int, after: int, out: NDArray[np.float32]) -> None:
        """Write the pyramid vectors of some of the windows, (k, inputs)."""
        self._pyramid.pool(self._run, self._spans[first:after], out)


def _frames_in(windows: Indices, frames: int) -> Mask:
    """Return which of some frames lie in windows (n, 2), (frames,)."""
    borders = np.zeros(frames + 1, np.intp)
    np.add.at(borders, windows[:, 0], 1)
    np.add.at(borders, windows[:, 1] + 1, -1)
    within: Mask = np.cumsum(borders)[:-1] > 0
    return within


def _read_in_mirror(model: PyramidModel, stream: LabelledStream, windows: Indices) -> NDArray[np.int64]:
    """Return for each window 1 where it is read as its mirror image, because the left arm acts in it, else 0."""
    if not model.metadata.mirrors:
        return np.zeros(len(windows), np.int64)
    moments = limb_moments(stream.postures)
    summed = np.concatenate([np.zeros_like(moments[:1]), np.cumsum(moments, axis=0)])
    return left_handed(summed[windows[:, 0]], summed[windows[:, 1] + 1]).astype(np.int64)
