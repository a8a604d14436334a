"""The self-organising map (Kohonen, 1982): a grid of units that learns the order of its inputs."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from actum.som.batch import BatchTraining
from actum.som.codebook import Codebook
from actum.som.inputs import float_type, training_vectors
from actum.som.linear import linear_weights
from actum.som.schedule import Decay, Report, falling, silent
from actum.som.sequential import SequentialTraining

REPORT_STEPS = 1000
"""Sequential steps between two reports of progress."""


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
    def random(cls, rows: int, cols: int, dim: int, rng: np.random.Generator, dtype: DTypeLike = np.float64) -> Self:
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
        return cls(rows, cols, linear_weights(inputs, rows, cols).astype(inputs.dtype))

    def train(
        self, vectors: ArrayLike, steps: int, schedule: Decay, rng: np.random.Generator, report: Report = silent
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
