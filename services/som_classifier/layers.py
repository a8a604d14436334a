"""The two layers of maps of the default recogniser, each answering with a soft activity."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import Som
from som_classifier.supervised import activity

Floats = NDArray[Any]


@dataclass(frozen=True, eq=False)
class FirstMaps:
    """The first layer: a map of postures and one of velocities, each answering with a soft activity.

    Attributes:
        contrasts: of each map's activity, in its squared distance.
    """

    postures: Som
    velocities: Som
    contrasts: tuple[float, float]

    @property
    def units(self) -> int:
        """How many there are in both."""
        return len(self.postures.weights) + len(self.velocities.weights)

    def activities(self, postures: Floats, velocities: Floats) -> Floats:
        """Return y = exp(−(d² − d²_min) / contrast) / Σ y of both maps for (n, 15, 3) inputs, shape (n, units)."""
        return np.concatenate(
            [
                shares(activity(som.excess2s(vectors.reshape(len(vectors), -1)), contrast))
                for som, vectors, contrast in self._with(postures, velocities)
            ],
            axis=1,
        )

    def activity(self, posture: Floats, velocity: Floats) -> Floats:
        """Return the same for one frame (15, 3), by products of one row, so that it never depends on other frames."""
        return np.concatenate(
            [
                shares(activity(som.excess2(vector.ravel()), contrast))
                for som, vector, contrast in self._with(posture, velocity)
            ]
        )

    def _with(self, posture: Floats, velocity: Floats) -> list[tuple[Som, Floats, float]]:
        return [(self.postures, posture, self.contrasts[0]), (self.velocities, velocity, self.contrasts[1])]


@dataclass(frozen=True, eq=False)
class Concepts:
    """The second layer: a map on which each action has its places, and whose activity the third layer hears.

    Attributes:
        layout: the map of the actions' scores.
        contrast: of its activity, in squared scores.
        mean: (units,), the mean activity of unit length in training: what all actions share says nothing.
    """

    layout: Som
    contrast: float
    mean: NDArray[np.float32]

    def activity(self, scores: Floats) -> Floats:
        """Return y = exp(−(d² − d²_min) / contrast) of unit length, less its mean, for scores (actions,)."""
        return self.centred(activity(self.layout.excess2(scores), self.contrast))

    def centred(self, activities: Floats) -> Floats:
        """Make activities (…, units) unit length and take the mean off."""
        lengths = np.sqrt(np.square(activities).sum(axis=-1, keepdims=True))
        centred: Floats = activities / lengths - self.mean
        return centred


def shares(activities: Floats) -> Floats:
    """Divide activities (…, units) by their sum."""
    divided: Floats = activities / activities.sum(axis=-1, keepdims=True)
    return divided
