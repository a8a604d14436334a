"""A person's stream through the first layer, and the pyramid vectors of any of its windows."""

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.augmentation import Variant
from actum_model_trainer.pooling import summed_activities
from actum_model_trainer.samples import LabelledStream
from som_classifier.frame_activity import UM_PER_M
from som_classifier.handedness import LimbSpreads, limb_moments
from som_classifier.pyramid import PrefixSums
from som_classifier.pyramid_model import PyramidModel


class EncodedStream:
    """The prefix sums of a stream's n frames, as seen and mirrored.

    Args:
        model: whose first layer and pyramid are used.
        stream: at least one frame.
        variant: its frames as measured or augmented; as measured unless given.
    """

    def __init__(self, model: PyramidModel, stream: LabelledStream, variant: Variant | None = None) -> None:
        self._pyramid, self._mirrors = model.pyramid, model.metadata.mirrors
        seen = variant or Variant((stream.postures, stream.velocities))
        sides = [seen, seen.mirrored] if self._mirrors else [seen]
        steps_um = np.rint(stream.motion * UM_PER_M).astype(np.int64).sum(axis=1)
        travelled_um = np.concatenate([[0], np.cumsum(steps_um)])
        self._sums = [PrefixSums(list(summed_activities(model.first, side)), travelled_um) for side in sides]
        moments = limb_moments(stream.postures)
        self._moments = np.concatenate([np.zeros_like(moments[:1]), np.cumsum(moments, axis=0)])

    def vector(self, first: int, last: int) -> NDArray[np.float32]:
        """Return the pyramid vector of the frames from `first` to `last`, both included, (inputs,)."""
        limbs = LimbSpreads.between(self._moments[first], self._moments[last + 1])
        side = int(self._mirrors and limbs.left_handed)
        return self._pyramid.vector(self._sums[side].between(first, last + 1))
