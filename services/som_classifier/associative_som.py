"""The associative self-organising map (A-SOM; Johnsson, Balkenius and Hesslow, 2009): it goes on without input.

A map's units are associated with the activity that followed. The ancillary input is the map's own activity, now and one
step before, so that the direction of a movement counts. The associated activity takes the place of the next one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats

STORED = np.float16
"""The precision of weights: its rounding is a thousandth of an activity, and the file is half as large."""


@dataclass(frozen=True, eq=False)
class AssociativeSom:
    """The weights of the ancillary input.

    Attributes:
        changes: (2, units, units), the weight from each unit now, and from each unit one step before, to each unit one
            step later, less 1 from a unit now to itself. Zeros stand for a map whose activity stays as it is.

    Raises:
        ValueError: the changes are not finite numbers of that shape.
    """

    changes: NDArray[np.float16]

    def __post_init__(self) -> None:
        shape = self.changes.shape
        if len(shape) != 3 or shape != (2, shape[1], shape[1]) or not np.isfinite(self.changes).all():
            raise ValueError(
                f"the associations have the shape {shape}, or are not all finite: give finite numbers of the shape (2, "
                "units, units)"
            )

    @classmethod
    def untrained(cls, units: int) -> "AssociativeSom":
        """Make a map that associates each unit with itself alone."""
        return cls(np.zeros((2, units, units), STORED))

    def continued(self, now: Floats, before: Floats, steps: int) -> Floats:
        """Return the activities (steps, …, units) that follow when each is fed back in the place of the next one.

        Args:
            now: (…, units), the activity.
            before: (…, units), the activity one step before.
            steps: how many.
        """
        from_now, from_before = self.changes.astype(np.float32)
        followed = []
        for _ in range(steps):
            now, before = now + now @ from_now + before @ from_before, now
            followed.append(now)
        return np.array(followed)

    def readings(self, values: Floats, steps: Sequence[int]) -> NDArray[np.float32]:
        """Return matrices that read off how a mean over units, weighted by activity, will have changed.

        Because associated activity is linear in the activity that is fed back, the change after any number of steps is
        [now, before] · matrix, without the activities in between.

        Args:
            values: (units, size), what each unit stands for.
            steps: rising, after how many.

        Returns:
            (2 * units, len(steps), size).
        """
        units = len(values)
        from_now, from_before = self.changes.astype(np.float32)
        of_now = (values - values.mean(axis=0)).astype(np.float32)
        present = np.concatenate([of_now, np.zeros_like(of_now)])
        reading, found = present, {0: present}
        for step in range(1, max(steps) + 1):
            later, then = reading[:units], reading[units:]
            reading = np.concatenate([later + from_now @ later + then, from_before @ later])
            found[step] = reading
        return np.stack([found[step] - present for step in steps], axis=1)
