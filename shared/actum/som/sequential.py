"""Sequential training: one input after the other moves its winner and the winner's neighbours (Kohonen, 1982)."""

from dataclasses import replace
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.core import steps
from actum.som import blas
from actum.som.codebook import Map
from actum.som.inputs import training_vectors
from actum.som.kernel import Kernel, adapt_compiled, adapt_in_numpy
from actum.som.schedule import Decay, checked_radii

Array = NDArray[Any]

CHUNK_STEPS = 250
"""Steps whose neighbourhoods are tabulated at once: enough to make the calls cheap, few enough for the cache."""


def fastest_kernel() -> Kernel:
    """Return the compiled kernel where it was compiled, else the one in NumPy."""
    return adapt_in_numpy if steps is None else adapt_compiled


class SequentialTraining(Generic[Map]):
    """A map while it learns from one input after the other: w += α G (x − w) (Kohonen, 1982).

    G = exp(−r² / 2 radius²), r the distance on the grid to the winner. Missing components (NaN) of an input adapt
    nothing.

    >>> from actum.som import Som, Steps
    >>> vectors = np.random.default_rng(0).random((100, 2))
    >>> order, decay = np.arange(300) % 100, Steps(np.full(300, 0.1), np.linspace(2.0, 0.5, 300))
    >>> training = SequentialTraining(Som.linear(4, 4, vectors), vectors, order, decay)
    >>> training.run(300)
    >>> training.steps_done
    300
    >>> training.som.quantization_error(vectors) < 0.2
    True
    """

    def __init__(
        self,
        som: Map,
        vectors: ArrayLike,
        order: ArrayLike,
        decay: Decay,
        kernel: Kernel | None = None,
    ) -> None:
        """Prepare one step per entry of `order`.

        Args:
            som: the map to start from, left as it is.
            vectors: the inputs, (n, dim).
            order: (steps,), the rows of `vectors` to learn from, in turn.
            decay: gives each step its α and its radius.
            kernel: how steps are computed, by default compiled; the map is the same.

        Raises:
            ValueError: the vectors do not fit the map, an entry names no row, or α or radius make no sense.
        """
        self.steps_done = 0
        self._start = som
        self._vectors = training_vectors(vectors, som.dim, som.dtype)
        self._order = _checked_order(order, len(self._vectors))
        alphas, radii = decay.values(len(self._order))
        self._radii = checked_radii(radii)
        self._alphas = _checked_alphas(alphas)
        self._weights = np.zeros((som.dim, blas.stride(len(som.weights), som.dtype)), som.dtype)
        self._weights[:, : len(som.weights)] = som.weights.T
        self._adapt = kernel or fastest_kernel()

    @property
    def som(self) -> Map:
        """The map as it is now."""
        return replace(self._start, weights=self._weights[:, : len(self._start.weights)].T)

    def run(self, steps: int) -> None:
        """Take the next steps, as many as are asked for and left."""
        end = min(self.steps_done + steps, len(self._order))
        while self.steps_done < end:
            chunk = slice(self.steps_done, min(self.steps_done + CHUNK_STEPS, end))
            self._adapt(self._weights, self._vectors[self._order[chunk]], *self._tables(chunk))
            self.steps_done = chunk.stop

    def _tables(self, chunk: slice) -> tuple[Array, Array]:
        """Tabulate what a kernel takes (see `adapt_in_numpy`): both kernels take exp from here, so they agree."""
        dtype, radii = self._start.dtype, self._radii[chunk]
        alphas = self._alphas[chunk, None].astype(dtype)
        over_rows = alphas * _gaussians(self._start.rows, radii).astype(dtype)
        return over_rows, _gaussians(self._start.cols, radii).astype(dtype)


def _gaussians(count: int, radii: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return exp(−r² / 2 radius²) at distances r of 0, 1, … `count` − 1 units and for radii (n,), shape (n, count)."""
    return np.exp(np.arange(count, dtype=np.float64) ** 2 * (-0.5 / radii[:, None] ** 2))


def _checked_order(order: ArrayLike, rows: int) -> NDArray[np.intp]:
    indices = np.array(order)
    if indices.ndim != 1 or (indices.size and not np.issubdtype(indices.dtype, np.integer)):
        raise ValueError(
            f"the argument 'order' has the type {indices.dtype} and the shape {indices.shape}: give one integer for "
            "each step, the row number of the vector to learn from"
        )
    if indices.size and (indices.min() < 0 or indices.max() >= rows):
        raise ValueError(
            f"the argument 'order' contains row numbers from {indices.min()} to {indices.max()}, but there are only "
            f"{rows} vectors: use row numbers from 0 to {rows - 1}"
        )
    return indices.astype(np.intp)


def _checked_alphas(alphas: ArrayLike) -> NDArray[np.float64]:
    values = np.array(alphas, np.float64)
    if not ((values >= 0) & (values <= 1)).all():
        raise ValueError(
            f"the smallest adaptation strength (alpha) is {values.min()} and the largest {values.max()}: give "
            "strengths from 0 to 1"
        )
    return values
