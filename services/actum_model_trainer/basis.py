"""A few directions in which nearly all of what training vectors differ lies: vectors as coordinates along them.

Ridge regression on coordinates costs a fraction of that on vectors, and coordinates of a whole training fit into a
model file, so that actions can be added to it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.products import blocks
from actum_model_trainer.side_by_side import side_by_side

Floats32 = NDArray[np.float32]

LANDMARKS = 2
"""Vectors that each direction is found from: more show the directions hardly better, and n vectors cost n³."""
SMALLEST_SHARE = 1e-6
"""Share of the landmarks' largest variance below which a direction is rounding error."""
AT_ONCE = 512
"""Vectors whose coordinates are computed at once, beside those of others."""
LEAST_NEW_SHARE = 1e-5
"""Share of the variance of all vectors below which a direction that a basis lacks is what rounding left of others."""


@dataclass(frozen=True, eq=False)
class Basis:
    """Orthonormal directions, and where they start.

    Attributes:
        mean: (inputs,).
        directions: (inputs, rank), in falling order of what the vectors differ in them.
    """

    mean: Floats32
    directions: Floats32

    @property
    def rank(self) -> int:
        """How many directions there are."""
        return int(self.directions.shape[1])

    @classmethod
    def of(cls, vectors: Floats32, rank: int) -> "Basis":
        """Find the principal directions of vectors (n, inputs), at most `rank`."""
        return cls.of_all([vectors], rank)

    @classmethod
    def of_all(cls, parts: Sequence[Floats32], rank: int) -> "Basis":
        """Find the principal directions of the vectors (n, inputs) of all parts, at most `rank`."""
        landmarks = _spread(parts, rank)
        mean = landmarks.mean(axis=0, dtype=np.float64).astype(np.float32)
        return cls(mean, _principal(landmarks - mean, rank))

    def extended(self, vectors: Floats32, most: int) -> "Basis":
        """Append the principal directions of what vectors (n, inputs) have beside these, at most so many.

        What they have is projected out twice: once leaves so much by rounding that directions would not be orthogonal.
        """
        beside = centred = _spread([vectors], most) - self.mean
        for _ in range(2):
            beside = beside - (beside @ self.directions) @ self.directions.T
        least = LEAST_NEW_SHARE * float(np.square(centred, dtype=np.float64).sum())
        return Basis(self.mean, np.hstack([self.directions, _principal(beside, most, least)]))

    def first(self, rank: int) -> "Basis":
        """Return the first directions alone."""
        return Basis(self.mean, self.directions[:, :rank])

    def coordinates(self, vectors: Floats32) -> Floats32:
        """Return the coordinates (n, rank) of vectors (n, inputs)."""
        start, coordinates = self.mean @ self.directions, np.empty((len(vectors), self.rank), np.float32)

        def compute(rows: slice) -> None:
            np.subtract(vectors[rows] @ self.directions, start, out=coordinates[rows])

        side_by_side(compute, blocks(len(vectors), AT_ONCE))
        return coordinates

    def moved(self, coordinates: Floats32, to: "Basis") -> Floats32:
        """Return coordinates (n, rank) as coordinates in another basis."""
        start = to.coordinates(self.mean[None])
        return (coordinates @ (self.directions.T @ to.directions) + start).astype(np.float32)

    def axes(self, of_coordinates: Floats32) -> Floats32:
        """Return axes for vectors (inputs, actions) of axes for their coordinates (rank, actions)."""
        return (self.directions @ of_coordinates).astype(np.float32)

    def offsets(self, of_coordinates: Floats32, axes: Floats32) -> Floats32:
        """Return the offsets (actions,) that go with axes for vectors, of those that go with coordinates."""
        return (of_coordinates - self.mean @ axes).astype(np.float32)


def _spread(parts: Sequence[Floats32], rank: int) -> Floats32:
    """Return some of the vectors of all parts, spread evenly, to find so many directions from."""
    count = sum(map(len, parts))
    numbers = np.linspace(0, count - 1, min(count, LANDMARKS * rank)).round().astype(np.intp)
    ends = np.cumsum([len(part) for part in parts])
    within = np.split(numbers, np.searchsorted(numbers, ends[:-1]))
    return np.concatenate([part[own - end + len(part)] for part, own, end in zip(parts, within, ends, strict=True)])


def _principal(centred: NDArray[np.floating[Any]], most: int, least: float = 0.0) -> Floats32:
    """Return the principal directions of centred vectors (n, inputs), at most so many, (inputs, directions).

    `least` is the smallest sum of squares along a direction.
    """
    variances, combinations = np.linalg.eigh((centred @ centred.T).astype(np.float64))
    kept = np.flatnonzero(variances > max(SMALLEST_SHARE * variances[-1], least))[::-1][:most]
    directions: Floats32 = centred.T @ (combinations[:, kept] / np.sqrt(variances[kept])).astype(np.float32)
    return directions
