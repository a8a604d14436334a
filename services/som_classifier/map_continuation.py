"""The continuation of preset `paper`: an associative map on the first map, part by part."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Floats
from actum.som import Som
from som_classifier.associative_som import AssociativeSom
from som_classifier.attention import PostureInput
from som_classifier.continuation import PREFIX, STEP_NS, STEPS, Continuation, smooth_posture_at
from som_classifier.frames import Frame
from som_classifier.map_activity import soft_activity

CHANGES, SHARES = f"{PREFIX}changes", f"{PREFIX}shares"


@dataclass(frozen=True, eq=False)
class MapContinuation(Continuation):
    """Continues the activity of the first map for each part, and reads displacements off the units' weights.

    Only how far the mean of the weights moves is read: how far the posture is from the map stays as it is.

    Attributes:
        som: the first map.
        contrast: of its soft activity, in squared metres.
        posture: its input.
        association: what activity follows which.
        shares: see `Continuation`.

    Raises:
        ValueError: the association is that of another map.
    """

    som: Som
    contrast: float
    posture: PostureInput
    association: AssociativeSom
    shares: NDArray[np.float32]

    def __post_init__(self) -> None:
        units, shares = self.association.changes.shape[1], (2, len(STEPS))
        if units != len(self.som.weights) or self.shares.shape != shares or not np.isfinite(self.shares).all():
            raise ValueError(
                "the model's arrays for predicting postures are damaged or belong to another map: train the model again"
            )

    @classmethod
    def restored(
        cls, som: Som, contrast: float, posture: PostureInput, arrays: Mapping[str, NDArray[Any]]
    ) -> "MapContinuation | None":
        """Build the continuation of a model file's arrays; None where these have none."""
        if CHANGES not in arrays:
            return None
        return cls(som, contrast, posture, AssociativeSom(arrays[CHANGES]), arrays[SHARES])

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays of a model file."""
        return {CHANGES: self.association.changes, SHARES: self.shares}

    def displacements(self, frames: Sequence[Frame]) -> Array:
        """Return how far each joint will have moved, (3, 15, 3), metres."""
        newest = frames[-1]
        assert newest.kinematics is not None
        before = smooth_posture_at(frames, newest.stamp_ns - STEP_NS)
        now_and_before = self.activities(np.stack([newest.kinematics.posture, before]))
        return self.read(now_and_before[:, 0], now_and_before[:, 1])

    def activities(self, postures: Array) -> Floats:
        """Return the map's activity for each part of upright postures (n, 15, 3), sum 1, (choices, n, units).

        It is 0 where all of a part is missing.
        """
        rows = np.stack([self.posture.rows(each, each) for each in postures], axis=1)
        flat = rows.reshape(-1, rows.shape[-1])
        known = ~np.isnan(flat).all(axis=1)
        activities = np.zeros((len(flat), len(self.som.weights)), np.float32)
        active = soft_activity(self.som.excess2s(flat[known]), self.contrast)
        activities[known] = active / active.sum(axis=1, keepdims=True)
        return activities.reshape(*rows.shape[:2], -1)

    def read(self, now: Floats, before: Floats) -> Array:
        """Return the displacements (3, 15, 3) that follow activities (choices, units) now and one step before."""
        rows = np.concatenate([now, before], axis=1) @ self._readings
        return self.posture.joints(rows.reshape(len(rows), len(STEPS), -1))

    @cached_property
    def _readings(self) -> NDArray[np.float32]:
        """What reads the displacements after each horizon, (2 * units, 3 * size)."""
        readings = self.association.readings(self.som.weights, STEPS)
        return readings.reshape(len(readings), -1)
