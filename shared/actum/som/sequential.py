"""Sequential training: one input after the other moves its winner and the winner's neighbours (Kohonen, 1982)."""

import hashlib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som import blas, storage
from actum.som.codebook import Map, map_arrays, stored_map
from actum.som.inputs import training_vectors
from actum.som.kernel import Kernel, adapt_in_numpy
from actum.som.schedule import Decay, Steps, checked_radii
from actum.som.storage import SomError

Array = NDArray[Any]

CHUNK_STEPS = 250
"""Steps whose neighbourhoods are tabulated at once: enough to make the calls cheap, few enough for the cache."""


@cache
def fastest_kernel() -> Kernel:
    """Return the compiled kernel where Numba can be imported, else the one in NumPy."""
    try:
        from actum.som.compiled import compiled_kernel

        return compiled_kernel()
    except ImportError:
        return adapt_in_numpy


class SequentialTraining(Generic[Map]):
    """A map while it learns from one input after the other: w += α G (x − w) (Kohonen, 1982).

    G = exp(−r² / 2 radius²), r the distance on the grid to the winner. Missing components (NaN) of an input adapt
    nothing. The state can be saved after any step; a resumed training gives the same map to the bit.

    >>> from actum.som import Som
    >>> vectors = np.random.default_rng(0).random((100, 2))
    >>> order, decay = np.arange(300) % 100, Steps(np.full(300, 0.1), np.linspace(2.0, 0.5, 300))
    >>> training = SequentialTraining(Som.linear(4, 4, vectors), vectors, order, decay)
    >>> training.run(200)
    >>> training.steps_done, training.steps
    (200, 300)
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
            kernel: how steps are computed, by default compiled where Numba is installed; the map is the same.

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
        self._weights = np.zeros((som.dim, blas.stride(som.grid.nodes, som.dtype)), som.dtype)
        self._weights[:, : som.grid.nodes] = som.weights.T
        self._adapt = kernel or fastest_kernel()

    @classmethod
    def drawn(
        cls, som: Map, vectors: ArrayLike, steps: int, decay: Decay, rng: np.random.Generator
    ) -> "SequentialTraining[Map]":
        """Prepare `steps` steps on rows of (n, dim) drawn at random, with replacement.

        Raises:
            ValueError: the vectors do not fit the map, or α or radius make no sense.
        """
        inputs = training_vectors(vectors, som.dim, som.dtype)
        return cls(som, inputs, rng.integers(len(inputs), size=steps), decay)

    @property
    def steps(self) -> int:
        """How many steps there are in all."""
        return len(self._order)

    @property
    def som(self) -> Map:
        """The map as it is now."""
        return replace(self._start, weights=self._weights[:, : self._start.grid.nodes].T)

    def run(self, steps: int) -> None:
        """Take the next steps, as many as are asked for and left."""
        end = min(self.steps_done + steps, self.steps)
        while self.steps_done < end:
            chunk = slice(self.steps_done, min(self.steps_done + CHUNK_STEPS, end))
            self._adapt(self._weights, self._vectors[self._order[chunk]], *self._tables(chunk))
            self.steps_done = chunk.stop

    def _tables(self, chunk: slice) -> tuple[Array, Array, NDArray[np.intp], int]:
        """Tabulate what a kernel takes (see `adapt_in_numpy`): both kernels take exp from here, so they agree."""
        grid, dtype = self._start.grid, self._start.dtype
        alphas = self._alphas[chunk, None].astype(dtype)
        over_rows = alphas * grid.row_gaussians(self._radii[chunk]).astype(dtype)
        over_cols = grid.col_gaussians(self._radii[chunk]).astype(dtype)
        return over_rows, over_cols, grid.shifts, grid.substeps

    def save(self, path: Path | str) -> None:
        """Write the map, the steps done, and order, α and radius of every step; not the vectors, only their digest.

        Raises:
            OSError: the file cannot be written.
        """
        storage.write(
            Path(path),
            storage.TRAINING_FORMAT,
            {
                **map_arrays(self.som),
                "vectors_digest": np.array(_digest(self._vectors)),
                "steps_done": np.array(self.steps_done),
                "order": self._order,
                "alphas": self._alphas,
                "radii": self._radii,
            },
        )

    @classmethod
    def load(
        cls, path: Path | str, vectors: ArrayLike, kind: type[Map], kernel: Kernel | None = None
    ) -> "SequentialTraining[Map]":
        """Resume a training that `save` wrote.

        Args:
            path: the file.
            vectors: the same inputs, (n, dim).
            kind: the class of the map.
            kernel: how steps are computed, as in the constructor.

        Raises:
            SomError: the file is missing, foreign or damaged, or was made with other vectors.
        """
        with storage.reading(Path(path), storage.TRAINING_FORMAT) as file:
            som, decay = stored_map(file, kind), Steps(file["alphas"], file["radii"])
            if str(file["vectors_digest"]) != _digest(np.array(vectors, som.dtype, order="C")):
                raise SomError(
                    Path(path),
                    "the training in this file began with other vectors: pass the vectors that it began with",
                )
            training = cls(som, vectors, file["order"], decay, kernel)
            training.steps_done = int(file["steps_done"])
            if not 0 <= training.steps_done <= training.steps:
                raise ValueError(f"it says that {training.steps_done} of {training.steps} steps are done")
        return training


def _checked_order(order: ArrayLike, rows: int) -> NDArray[np.intp]:
    indices = np.array(order)
    if indices.ndim != 1 or (indices.size and not np.issubdtype(indices.dtype, np.integer)):
        raise ValueError(f"the order has to be an array of row numbers, not {indices.dtype} of shape {indices.shape}")
    if indices.size and (indices.min() < 0 or indices.max() >= rows):
        raise ValueError(f"the order contains rows {indices.min()} to {indices.max()}, but there are only {rows} rows")
    return indices.astype(np.intp)


def _checked_alphas(alphas: ArrayLike) -> NDArray[np.float64]:
    values = np.array(alphas, np.float64)
    if not ((values >= 0) & (values <= 1)).all():
        raise ValueError(f"adaptation strengths (alpha) must be from 0 to 1; got {values.min()} to {values.max()}")
    return values


def _digest(vectors: Array) -> str:
    return hashlib.sha256(f"{vectors.shape} {vectors.dtype.str}".encode() + vectors.tobytes()).hexdigest()
