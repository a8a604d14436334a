"""What a map is when it is not learning: weights on a grid, looked up and measured."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, Self, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som import measures, storage
from actum.som.grid import Grid, Topology
from actum.som.lookup import Lookup, check_rows, is_complete

Array = NDArray[Any]
Indices = NDArray[np.intp]
Map = TypeVar("Map", bound="Codebook")


@dataclass(frozen=True, eq=False)
class Codebook:
    """A weight vector for each unit of a grid; unit k stands at row k // cols, column k % cols.

    Inputs are converted to the weights' precision. Components of an input that are NaN count as missing: they are
    left out of the distance to every unit, and the squared distance is scaled up by dim / known. As distances are
    squared, single precision tells apart only what differs by more than 1e-19.

    Attributes:
        weights: (rows * cols, dim), read-only, float32 or float64 as given.
    """

    rows: int
    cols: int
    weights: Array
    topology: Topology = "rectangular"

    def __post_init__(self) -> None:
        weights = np.array(self.weights, dtype=float_type(self.weights), order="C")
        fits = weights.ndim == 2 and weights.shape[0] == self.grid.nodes and weights.shape[1] > 0
        if not fits or not np.isfinite(weights).all():
            raise ValueError(f"weights of shape {weights.shape} are no {self.rows}×{self.cols} finite vectors")
        check_squarable(weights)
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy what makes the map; NumPy's own copies of its weights could be written to."""
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    @classmethod
    def of_planes(cls, planes: ArrayLike, topology: Topology = "rectangular") -> Self:
        """Make a map of its component planes (rows, cols, dim).

        Raises:
            ValueError: they have another shape or are not finite.
        """
        stacked = np.asarray(planes)
        if stacked.ndim != 3:
            raise ValueError(f"component planes of shape {stacked.shape} are not rows × cols × dim")
        rows, cols, dim = stacked.shape
        return cls(rows, cols, stacked.reshape(rows * cols, dim), topology)

    @property
    def dim(self) -> int:
        """The length of an input vector."""
        return int(self.weights.shape[1])

    @property
    def dtype(self) -> np.dtype[np.floating]:
        """The precision that the map is kept in and computes in."""
        return self.weights.dtype

    @cached_property
    def grid(self) -> Grid:
        """Where the units stand."""
        return Grid(self.rows, self.cols, self.topology)

    @property
    def coordinates(self) -> NDArray[np.float64]:
        """Row and column of each unit, shape (rows * cols, 2)."""
        return self.grid.coordinates

    @cached_property
    def planes(self) -> Array:
        """The weights as component planes, read-only, shape (rows, cols, dim)."""
        return self.weights.reshape(self.rows, self.cols, self.dim)

    def bmu(self, x: ArrayLike) -> int:
        """Find the best matching unit of x (dim,), argmin ‖x − w‖, in one BLAS call; the first of equals.

        Raises:
            ValueError: x has another length, an infinite component or no known one.
        """
        return int(self.lookup.score(numbers(x)).argmin())

    def bmus(self, vectors: ArrayLike) -> Indices:
        """Find the best matching unit of each row of (n, dim). Shape (n,).

        The same for any number of BLAS threads. Where two runs must agree on ties to the bit, n must agree too.
        """
        return self.lookup.winners(numbers(vectors))

    def best_two(self, vectors: ArrayLike) -> Indices:
        """Find the best and the second-best matching unit of each row of (n, dim). Shape (n, 2).

        Raises:
            ValueError: the map has one unit only.
        """
        if self.grid.nodes < 2:
            raise ValueError("a map of one unit has no second-best one")
        rows = numbers(vectors)
        found = np.empty((len(rows), 2), np.intp)
        for chunk, scores in self.lookup.scores(rows):
            best = scores.argmin(axis=1)
            np.put_along_axis(scores, best[:, None], np.inf, axis=1)
            found[chunk] = np.stack([best, scores.argmin(axis=1)], axis=1)
        return found

    def excess2(self, x: ArrayLike) -> Array:
        """Return each unit's squared distance to x beyond the winner's, d² − d²_min, shape (rows * cols,).

        |x|² cancels, so that the differences stay exact however far x lies from the map.
        """
        scores = self.lookup.score(numbers(x))[: len(self.weights)]
        scores -= scores[scores.argmin()]
        scores *= 2
        return scores

    def excess2s(self, vectors: ArrayLike) -> Array:
        """Return d² − d²_min of each row of (n, dim) to each unit, shape (n, rows * cols)."""
        rows = numbers(vectors)
        excess2 = np.empty((len(rows), self.grid.nodes), self.dtype)
        for chunk, scores in self.lookup.scores(rows):
            np.subtract(scores[:, : self.grid.nodes], scores.min(axis=1, keepdims=True), out=excess2[chunk])
        excess2 *= 2
        return excess2

    def distances2(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return each unit's squared Euclidean distance to x, shape (rows * cols,)."""
        row = numbers(x)[None]
        check_rows(row, self.dim)
        is_complete(row)
        return measures.partial_distances2(row, self.weights)

    def quantization_error(self, vectors: ArrayLike) -> float:
        """Return the mean distance of the rows of (n, dim) to their winners.

        Raises:
            ValueError: there is no row.
        """
        rows = some_rows(vectors)
        return float(np.sqrt(measures.partial_distances2(rows, self.weights[self.bmus(rows)])).mean())

    def topographic_error(self, vectors: ArrayLike, neighbours: int | None = None) -> float:
        """Return the share of the rows of (n, dim) whose two best units are no neighbours on the grid.

        Args:
            vectors: the inputs.
            neighbours: 8, the default, or 4; on a hexagonal grid 6.

        Raises:
            ValueError: there is no row, no second unit, or no such number of neighbours.
        """
        return measures.topographic_error(self.best_two(some_rows(vectors)), self.grid, neighbours)

    def u_matrix(self, neighbours: int | None = None) -> NDArray[np.float64]:
        """Return each unit's mean distance to its grid neighbours' weights, shape (rows, cols)."""
        return measures.u_matrix(self.weights, self.grid, neighbours)

    def hits(self, vectors: ArrayLike) -> Indices:
        """Return how many rows of (n, dim) each unit wins, shape (rows, cols)."""
        return measures.hits(self.bmus(vectors), self.grid)

    def save(self, path: Path | str) -> None:
        """Write the map as npz without pickle, in one step.

        Raises:
            OSError: the file cannot be written.
        """
        storage.write(Path(path), storage.MAP_FORMAT, map_arrays(self))

    @classmethod
    def load(cls, path: Path | str) -> Self:
        """Read a map that `save` wrote.

        Raises:
            SomError: the file is missing, foreign or damaged.
        """
        with storage.reading(Path(path), storage.MAP_FORMAT) as file:
            return stored_map(file, cls)

    @cached_property
    def lookup(self) -> Lookup:
        """The weights laid out for comparing."""
        return Lookup(self.weights)


def map_arrays(som: Codebook) -> dict[str, Array]:
    """Return what a file holds of a map."""
    return {"weights": som.planes, "topology": np.array(som.topology)}


def stored_map(file: Mapping[str, Array], kind: type[Map]) -> Map:
    """Make a map of what a file holds.

    Raises:
        ValueError, KeyError: the file holds something else.
    """
    return kind.of_planes(file["weights"], cast(Topology, str(file["topology"])))


def some_rows(vectors: ArrayLike) -> Array:
    """Return the vectors (n, dim) as an array.

    Raises:
        ValueError: there is none.
    """
    rows = numbers(vectors)
    if not len(rows):
        raise ValueError("there are no vectors to measure a map with")
    return rows


def float_type(values: ArrayLike) -> np.dtype[np.floating]:
    """Return float32 for float32 values, float64 for all others."""
    return np.dtype(np.float32 if np.asarray(values).dtype == np.float32 else np.float64)


def numbers(values: ArrayLike) -> Array:
    """Return values as an array in their own precision, in double where they are no floats; None is NaN."""
    given = np.asarray(values)
    return given if given.dtype.kind == "f" else np.asarray(values, np.float64)


def check_squarable(values: Array) -> None:
    """Refuse values (n, dim) whose squared distances their precision cannot hold.

    Raises:
        ValueError: with the largest.
    """
    largest = np.nanmax(np.abs(values))
    if largest > np.sqrt(np.finfo(values.dtype).max / values.shape[1]) / 4:
        raise ValueError(f"values up to {largest:.0e} are too large for distances in {values.dtype}: scale them down")


def training_vectors(vectors: ArrayLike, dim: int, dtype: np.dtype[np.floating]) -> Array:
    """Return the rows to learn from, (n, dim) in a map's precision.

    Raises:
        ValueError: there is none, its length is another, or one is infinite, too large to be squared, or has no
            known component.
    """
    inputs = np.array(vectors, dtype=dtype, order="C")
    if inputs.ndim != 2 or inputs.shape[1] != dim or not len(inputs):
        raise ValueError(f"cannot train on shape {inputs.shape}: needs n > 0 rows of {dim}")
    try:
        is_complete(inputs)
        check_squarable(inputs)
    except ValueError as error:
        raise ValueError(f"cannot train on these vectors: {error}") from None
    return inputs
