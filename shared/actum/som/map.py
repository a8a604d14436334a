"""The self-organising map (Kohonen, 1982): a grid of units that learns the order of its inputs."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from actum.som.batch import BatchTraining
from actum.som.blas import matmul
from actum.som.codebook import Codebook, unit_coordinates
from actum.som.inputs import float_type, training_vectors
from actum.som.schedule import Decay, Report, falling, silent
from actum.som.sequential import SequentialTraining

Doubles = NDArray[np.float64]

REPORT_STEPS = 1000
"""Sequential steps between two reports of progress."""
_ROUNDS = 100
"""Orthogonal iterations; in each the error falls by the ratio of the seventh variance to the second."""
_DIRECTIONS = 6
"""Directions that are iterated: with more than the two that are needed, these converge faster."""


@dataclass(frozen=True, eq=False)
class Som(Codebook):
    """A map of `rows` × `cols` units that can learn; learning returns a new map. See `Codebook` for its attributes.

    >>> vectors = np.random.default_rng(0).random((200, 3))
    >>> som = Som.linear(5, 6, vectors).train_batch(vectors, epochs=10, radius=(3.0, 0.6))
    >>> som.planes.shape, som.bmus(vectors).shape
    ((5, 6, 3), (200,))
    >>> som.quantization_error(vectors) < 0.2
    True
    """

    @classmethod
    def random(cls, rows: int, cols: int, dim: int, rng: "np.random.Generator", dtype: DTypeLike = np.float64) -> Self:
        """Make an untrained map of inputs (dim,), all weights drawn from U(0, 1).

        Raises:
            ValueError: there is no unit, or no component.
        """
        return cls(rows, cols, rng.random((rows * cols, dim)).astype(dtype))

    @classmethod
    def linear(cls, rows: int, cols: int, vectors: ArrayLike) -> Self:
        """Make an untrained map on the plane of the first two principal components of the rows of (n, dim).

        The same vectors make the same map, in their precision: float32 or float64.

        Raises:
            ValueError: the vectors are no rows with known components, or there is no unit.
        """
        rows_given = np.asarray(vectors)
        dim = rows_given.shape[-1] if rows_given.ndim else 0
        inputs = training_vectors(rows_given, dim, float_type(rows_given))
        return cls(rows, cols, _linear_weights(inputs, rows, cols).astype(inputs.dtype))

    def train(
        self, vectors: ArrayLike, steps: int, schedule: Decay, rng: "np.random.Generator", report: Report = silent
    ) -> Self:
        """Return the map after `steps` sequential adaptations to randomly chosen rows of (n, dim).

        w += α G (x − w) with the Gaussian neighbourhood G = exp(−r² / 2 radius²), r the distance on the grid
        to the winner (Kohonen, 1982).

        Args:
            vectors: the inputs, (n, dim).
            steps: how many.
            schedule: gives each step its α and its radius.
            rng: draws the rows, with replacement.
            report: called with the steps done and those in all, every 1000 steps.

        Raises:
            ValueError: the vectors do not fit the map, or α or a radius makes no sense.
        """
        inputs = training_vectors(vectors, self.dim, self.dtype)
        training = SequentialTraining(self, inputs, rng.integers(len(inputs), size=steps), schedule)
        while training.steps_done < steps:
            report(training.steps_done, steps)
            training.run(REPORT_STEPS)
        report(steps, steps)
        return training.som

    def train_batch(
        self, vectors: ArrayLike, epochs: int, radius: tuple[float, float], report: Report = silent
    ) -> Self:
        """Return the map after `epochs` batch adaptations to all rows of (n, dim).

        Each unit moves to the mean of the inputs that its neighbourhood won; the radius falls exponentially from the
        first value to the second. The result is the same for any number of threads (Kohonen, 2013).

        Args:
            vectors: the inputs, (n, dim).
            epochs: how often all of them are shown.
            radius: of the neighbourhood in the first and in the last epoch, grid units.
            report: called with the epochs done and those in all.

        Raises:
            ValueError: the vectors do not fit the map, or a radius is not above 0.
        """
        training = BatchTraining(self, vectors, falling(*radius, epochs))
        for epoch in range(epochs):
            report(epoch, epochs)
            training.run_epoch()
        report(epochs, epochs)
        return training.som


def _linear_weights(vectors: NDArray[Any], rows: int, cols: int) -> Doubles:
    """Return weights on the plane of the first two principal components of vectors (n, dim), shape (nodes, dim).

    The plane spans ± two standard deviations, with the first component along the longer side of the grid. Missing
    values (NaN) are taken as the mean of the others.

    Raises:
        ValueError: a component is missing in every vector: remove or fill it. Or there is no unit.
    """
    if min(rows, cols) < 1:
        raise ValueError(f"a map of {rows}×{cols} units is empty: use at least 1×1")
    known = ~np.isnan(vectors)
    if not known.any(axis=0).all():
        component = np.flatnonzero(~known.any(axis=0))[0]
        raise ValueError(
            f"component {component} is NaN in every vector: remove this component, or replace the NaN values by numbers"
        )
    mean = np.nanmean(vectors, axis=0, dtype=np.float64)
    axes = _principal_axes(np.where(known, vectors - mean, 0.0))
    return mean + 2 * matmul(_scaled(unit_coordinates(rows, cols)), axes if rows >= cols else axes[::-1])


def _principal_axes(centred: Doubles) -> Doubles:
    """Return the first two principal components of (n, dim), each as long as its standard deviation. Shape (2, dim).

    The largest component of each is positive. LAPACK's eigenvectors of large matrices change with the number of
    threads, so the matrix is first brought down to a few directions by orthogonal iteration.
    """
    covariance = matmul(centred.T, centred) / len(centred)
    dim = len(covariance)
    basis = np.random.default_rng(0).standard_normal((dim, min(dim, _DIRECTIONS)))
    for _ in range(_ROUNDS):
        basis = np.linalg.qr(matmul(covariance, basis))[0]
    variances, turns = np.linalg.eigh(matmul(basis.T, matmul(covariance, basis)))
    axes = np.zeros((2, dim))
    axes[: len(variances)] = (matmul(basis, turns) * np.sqrt(np.maximum(variances, 0))).T[:-3:-1]
    largest = np.take_along_axis(axes, np.abs(axes).argmax(axis=1)[:, None], axis=1)
    signed: Doubles = axes * np.where(largest < 0, -1.0, 1.0)
    return signed


def _scaled(positions: Doubles) -> Doubles:
    """Scale each coordinate of (nodes, 2) to [−1, 1]; 0 where all are the same."""
    middle = (positions.max(axis=0) + positions.min(axis=0)) / 2
    half = np.ptp(positions, axis=0) / 2
    scaled: Doubles = np.divide(positions - middle, half, out=np.zeros_like(positions), where=half > 0)
    return scaled
