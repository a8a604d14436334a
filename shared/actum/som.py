"""The self-organising map (Kohonen): a grid of neurons that orders what it is shown (paper, section 2.1)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Report = Callable[[int, int], None]
"""Called with the steps done and the steps in all."""

CHUNK_ROWS = 256
REPORT_STEPS = 1000


def _silent(done: int, total: int) -> None:
    pass


@dataclass(frozen=True)
class Schedule:
    """How adaptation strength and neighbourhood radius (grid units) fall over the steps of a training.

    Both fall exponentially from the first value, reached at the first step, to the second, reached at the last.
    """

    alpha: tuple[float, float]
    radius: tuple[float, float]

    def values(self, steps: int) -> tuple[Array, Array]:
        """Return α and radius of each step, each of shape (steps,)."""
        return _falling(*self.alpha, steps), _falling(*self.radius, steps)


@dataclass(frozen=True, eq=False)
class Som:
    """A map of `rows` × `cols` neurons; neuron k stands at row k // cols, column k % cols.

    Attributes:
        weights: (rows * cols, dim), read-only.
    """

    rows: int
    cols: int
    weights: Array

    def __post_init__(self) -> None:
        weights = np.array(self.weights, dtype=np.float64, order="C")
        if weights.ndim != 2 or weights.shape[0] != self.rows * self.cols or not np.isfinite(weights).all():
            raise ValueError(f"weights of shape {weights.shape} are no {self.rows}×{self.cols} finite vectors")
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    @classmethod
    def random(cls, rows: int, cols: int, dim: int, rng: np.random.Generator) -> "Som":
        """Make an untrained map, all weights drawn from U(0, 1)."""
        return cls(rows, cols, rng.random((rows * cols, dim)))

    @property
    def dim(self) -> int:
        """The length of an input vector."""
        return int(self.weights.shape[1])

    @cached_property
    def coordinates(self) -> Array:
        """Row and column of each neuron, shape (rows * cols, 2)."""
        return np.stack(np.divmod(np.arange(self.rows * self.cols), self.cols), axis=1).astype(np.float64)

    @cached_property
    def _half_norms2(self) -> Array:
        return 0.5 * _squared_lengths(self.weights)

    def excess2(self, x: Array) -> Array:
        """Return each neuron's squared distance to x beyond the winner's, d² − d²_min, shape (rows * cols,).

        |x|² cancels, so that the differences stay exact however far x lies from the map.
        """
        scores = self._half_norms2 - self.weights @ x
        excess2: Array = 2.0 * (scores - scores.min())
        return excess2

    def distances2(self, x: Array) -> Array:
        """Return each neuron's squared Euclidean distance to x, shape (rows * cols,)."""
        return _squared_lengths(self.weights - x)

    def bmu(self, x: Array) -> int:
        """Find the best matching unit, argmin ‖x − w‖, in one BLAS call; the first of equals."""
        return int(np.argmin(self._half_norms2 - self.weights @ x))

    def bmus(self, vectors: Array) -> Indices:
        """Find the best matching unit of each row of (n, dim). Shape (n,).

        A matrix product rounds differently for different n: where two runs must agree to the bit, n must too.
        """
        found = np.empty(len(vectors), dtype=np.intp)
        for chunk in _chunks(len(vectors)):
            np.argmin(self._scores(vectors[chunk]), axis=1, out=found[chunk])
        return found

    def train(
        self,
        vectors: ArrayLike,
        steps: int,
        schedule: Schedule,
        rng: np.random.Generator,
        report: Report = _silent,
    ) -> "Som":
        """Return the map after `steps` sequential adaptations to randomly chosen rows of (n, dim).

        w += α G (x − w) with the Gaussian neighbourhood G = exp(−r² / 2 radius²), r the distance on the grid
        to the winner.
        """
        inputs = np.asarray(vectors, dtype=np.float64)
        if inputs.ndim != 2 or inputs.shape[1] != self.dim or not len(inputs) or not np.isfinite(inputs).all():
            raise ValueError(f"cannot train on shape {inputs.shape}: needs n > 0 finite rows of {self.dim}")
        training = _Training(self)
        chosen = rng.integers(len(inputs), size=steps)
        for step, (index, alpha, radius) in enumerate(zip(chosen, *schedule.values(steps), strict=True)):
            training.adapt(inputs[index], alpha, radius)
            if step % REPORT_STEPS == 0:
                report(step, steps)
        report(steps, steps)
        return Som(self.rows, self.cols, training.weights.T)

    def quantization_error(self, vectors: Array) -> float:
        """Return the mean distance of the rows of (n, dim) to their winners."""
        nearest = self.weights[self.bmus(vectors)]
        return float(np.linalg.norm(vectors - nearest, axis=1).mean())

    def topographic_error(self, vectors: Array) -> float:
        """Return the share of the rows of (n, dim) whose two best units are no neighbours (of 8) on the grid."""
        apart = 0
        for chunk in _chunks(len(vectors)):
            best = np.argpartition(self._scores(vectors[chunk]), 1, axis=1)[:, :2]
            steps = np.abs(np.diff(self.coordinates[best], axis=1)).max(axis=(1, 2))
            apart += int((steps > 1).sum())
        return apart / len(vectors)

    def _scores(self, vectors: Array) -> Array:
        """Half the squared distances less ½|x|²: the same order along each row. Shape (n, rows * cols)."""
        return self._half_norms2 - vectors @ self.weights.T


class _Training:
    """A map while it learns. The weights are kept as (dim, neurons), so that every operation runs along memory."""

    def __init__(self, som: Som) -> None:
        self.weights = np.array(som.weights.T, order="C")
        self._som = som
        self._difference = np.empty_like(self.weights)
        self._distance2 = np.empty(self.weights.shape[1])
        reach = max(som.rows, som.cols)
        self._grid_distance2 = np.arange(1 - reach, reach, dtype=np.float64) ** 2
        self._origin = reach - 1

    def adapt(self, x: Array, alpha: float, radius: float) -> None:
        difference = np.subtract(x[:, None], self.weights, out=self._difference)
        np.einsum("ij,ij->j", difference, difference, out=self._distance2)
        difference *= self._neighbourhood(int(self._distance2.argmin()), alpha, radius)
        self.weights += difference

    def _neighbourhood(self, winner: int, alpha: float, radius: float) -> Array:
        """α G of every neuron; the Gaussian of the grid distance is the product of one over rows and one over cols."""
        row, col = divmod(winner, self._som.cols)
        gauss = np.exp(self._grid_distance2 * (-0.5 / radius**2))
        over_rows = alpha * gauss[self._origin - row : self._origin - row + self._som.rows]
        over_cols = gauss[self._origin - col : self._origin - col + self._som.cols]
        return np.multiply.outer(over_rows, over_cols).ravel()


def _squared_lengths(vectors: Array) -> Array:
    lengths2: Array = np.einsum("ij,ij->i", vectors, vectors)
    return lengths2


def _falling(first: float, last: float, steps: int) -> Array:
    return np.geomspace(first, last, steps)


def _chunks(rows: int) -> list[slice]:
    return [slice(start, min(start + CHUNK_ROWS, rows)) for start in range(0, rows, CHUNK_ROWS)]
