"""The continuation of the default preset: a linear regression on posture, velocity and first-layer activity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.skeletons import JOINTS
from som_classifier.continuation import PREFIX, STEPS, Continuation
from som_classifier.first_layer import frame_inputs
from som_classifier.frames import Frame
from som_classifier.pyramid import SCALE

INPUTS = 6 * len(JOINTS)
"""Components of a posture and its velocity."""
ANSWERS = 3 * len(JOINTS) * len(STEPS)
"""Components of the displacements of all joints after all horizons."""

Floats32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class RegressedContinuation(Continuation):
    """Displacements = [posture and velocity less the usual ones, activity] · axes · directions + offsets.

    Attributes:
        usual: (90,), mean of posture and velocity in training, which stands for what is missing.
        axes: (90 + units of the first layer, rank).
        directions: (rank, 135), displacements of all joints after all horizons that occur together.
        offsets: (135,).
        shares: see `Continuation`.

    Raises:
        ValueError: the arrays do not fit together.
    """

    usual: Floats32
    axes: Floats32
    directions: Floats32
    offsets: Floats32
    shares: Floats32

    def __post_init__(self) -> None:
        rank = self.axes.shape[-1]
        shapes = tuple(each.shape for each in (self.usual, self.directions, self.offsets, self.shares))
        expected = (INPUTS,), (rank, ANSWERS), (ANSWERS,), (2, len(STEPS))
        if shapes != expected:
            raise ValueError(
                f"the model's arrays for predicting postures have the shapes {shapes} instead of {expected}: train the "
                "model again"
            )

    @classmethod
    def restored(cls, arrays: Mapping[str, NDArray[Any]]) -> "RegressedContinuation | None":
        """Build the continuation of a model file's arrays; None where these have none."""
        if f"{PREFIX}axes" not in arrays:
            return None
        return cls(**{each.name: arrays[PREFIX + each.name] for each in fields(cls)})

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays of a model file."""
        return {PREFIX + each.name: getattr(self, each.name) for each in fields(self)}

    def displacements(self, frames: Sequence[Frame]) -> Array:
        """Return how far each joint will have moved, (3, 15, 3), metres; of the frames only the newest counts."""
        newest = frames[-1]
        assert newest.kinematics is not None
        inputs = frame_inputs(*newest.kinematics)[0] - self.usual
        before, after = newest.activity.before[0], newest.activity.after[0]
        activity = (after - before).astype(np.float32) / SCALE
        found = np.nan_to_num(inputs).astype(np.float32) @ self.axes[:INPUTS] + activity @ self.axes[INPUTS:]
        displacements: Array = found @ self.directions + self.offsets
        return displacements.reshape(len(STEPS), len(JOINTS), 3)
