"""The second layer of the default recogniser: a map of the actions' scores."""

from dataclasses import dataclass
from functools import cached_property
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats
from actum.core import steps
from actum.som import Som
from som_classifier.map_activity import soft_activity


@dataclass(frozen=True, eq=False)
class ActionMap:
    """A map of score vectors, on which each action has regions of its own; its activity is the third layer's input.

    Attributes:
        som: the map, of as many input dimensions as there are actions.
        contrast: of its soft activity, in squared scores.
        mean: (units,), the mean of the unit-length activities in training, which is subtracted: activity common to all
            actions does not separate them.
    """

    som: Som
    contrast: float
    mean: NDArray[np.float32]

    def activity(self, scores: Floats) -> Floats:
        """Return the soft activity of unit length, less its mean, for scores (actions,). Shape (units,)."""
        if steps is not None and self.som.dtype == np.float32:
            return self._compiled_activity(steps, scores)
        activities = soft_activity(self.som.excess2(scores), self.contrast)
        activities /= np.sqrt(activities @ activities)
        activities -= self.mean
        return activities

    def _compiled_activity(self, steps: ModuleType, scores: Floats) -> NDArray[np.float32]:
        activities = np.empty(len(self.mean), np.float32)
        steps.contrasted(self.som.lookup.score(scores), self.contrast, activities)
        np.exp(activities, out=activities)
        steps.centred(activities, activities.dot(activities), self._mean_bytes)
        return activities

    @cached_property
    def _mean_bytes(self) -> bytes:
        return self.mean.tobytes()

    def centred(self, activities: Floats) -> Floats:
        """Scale soft activities (…, units) to unit length and subtract the mean. Same shape."""
        lengths = np.sqrt(np.square(activities).sum(axis=-1, keepdims=True))
        centred: Floats = activities / lengths - self.mean
        return centred
