"""The self-organising map (Kohonen): a grid of units that orders what it is shown."""

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from actum.som.batch import BatchTraining
from actum.som.codebook import Codebook, float_type, training_vectors
from actum.som.grid import Grid, Topology
from actum.som.linear import linear_weights
from actum.som.schedule import Decay, Report, Steps, falling, silent
from actum.som.sequential import SequentialTraining

REPORT_STEPS = 1000


@dataclass(frozen=True, eq=False)
class Som(Codebook):
    """A map of `rows` × `cols` units that can learn; learning returns a new map.

    Attributes:
        weights: (rows * cols, dim), read-only, float32 or float64 as given.
    """

    @classmethod
    def random(
        cls,
        rows: int,
        cols: int,
        dim: int,
        rng: np.random.Generator,
        dtype: DTypeLike = np.float64,
        topology: Topology = "rectangular",
    ) -> Self:
        """Make an untrained map, all weights drawn from U(0, 1)."""
        return cls(rows, cols, rng.random((rows * cols, dim)).astype(dtype), topology)

    @classmethod
    def linear(cls, rows: int, cols: int, vectors: ArrayLike, topology: Topology = "rectangular") -> Self:
        """Make an untrained map that lies flat along the two main directions of the rows of (n, dim).

        The same vectors make the same map, in their precision: float32 or float64.

        Raises:
            ValueError: the vectors are no rows with known components.
        """
        shown = np.asarray(vectors)
        inputs = training_vectors(shown, shown.shape[-1] if shown.ndim else 0, float_type(shown))
        return cls(rows, cols, linear_weights(inputs, Grid(rows, cols, topology)).astype(inputs.dtype), topology)

    def train(
        self, vectors: ArrayLike, steps: int, schedule: Decay, rng: np.random.Generator, report: Report = silent
    ) -> Self:
        """Return the map after `steps` sequential adaptations to randomly chosen rows of (n, dim).

        w += α G (x − w) with the Gaussian neighbourhood G = exp(−r² / 2 radius²), r the distance on the grid
        to the winner.

        Raises:
            ValueError: the vectors do not fit the map, or α or a radius makes no sense.
        """
        training = SequentialTraining.drawn(self, vectors, steps, schedule, rng)
        while training.steps_done < steps:
            report(training.steps_done, steps)
            training.run(REPORT_STEPS)
        report(steps, steps)
        return training.som

    def train_batch(
        self, vectors: ArrayLike, epochs: int, radius: tuple[float, float], report: Report = silent
    ) -> Self:
        """Return the map after `epochs` batch adaptations to all rows of (n, dim).

        Each unit moves to the mean of what its neighbourhood won; the radius falls exponentially from the first value
        to the second. The result is the same for any number of threads.

        Raises:
            ValueError: the vectors do not fit the map, or a radius is not above 0.
        """
        training = BatchTraining(self, vectors, falling(*radius, epochs))
        for epoch in range(epochs):
            report(epoch, epochs)
            training.run_epoch()
        report(epochs, epochs)
        return training.som

    @classmethod
    def resume(cls, path: Path | str, vectors: ArrayLike) -> SequentialTraining[Self]:
        """Take up a sequential training where `SequentialTraining.save` left it, with the same vectors.

        Raises:
            SomError: the file is missing, foreign or damaged, or was made with other vectors.
        """
        return SequentialTraining.load(path, vectors, cls)

    def partial_fit(self, vectors: ArrayLike, alpha: float, radius: float) -> Self:
        """Return the map after one adaptation to each row of (n, dim), in their order, at constant α and radius.

        Raises:
            ValueError: the vectors do not fit the map, α is not from 0 to 1, or the radius not above 0.
        """
        inputs = training_vectors(vectors, self.dim, self.dtype)
        constant = Steps(np.full(len(inputs), alpha), np.full(len(inputs), radius))
        training = SequentialTraining(self, inputs, np.arange(len(inputs)), constant)
        training.run(training.steps)
        return training.som
