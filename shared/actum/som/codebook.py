"""The codebook of a map: weights on a grid, to be looked up, measured and stored, but not trained."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, Self, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som import measures, storage
from actum.som.grid import Grid, Topology
from actum.som.inputs import check_rows, check_squarable, float_type, is_complete, numbers, some_rows
from actum.som.lookup import Lookup

Array = NDArray[Any]
Indices = NDArray[np.intp]
Map = TypeVar("Map", bound="Codebook")


@dataclass(frozen=True, eq=False)
class Codebook:
    """A weight vector for each unit of a grid; unit k stands at row k // cols, column k % cols.

    Inputs are converted to the weights' precision. Components of an input that are NaN count as missing: they are
    left out of the distance to every unit, and the squared distance is scaled up by dim / known. As distances are
    squared, single precision tells apart only what differs by more than 1e-19.

    >>> codebook = Codebook(1, 3, [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]])
    >>> codebook.bmu([0.9, 0.2]), codebook.bmus([[0.0, 1.9], [np.nan, 0.1]]).tolist()
    (1, [2, 0])
    >>> codebook.distances2([0.0, 1.0]).tolist()
    [1.0, 2.0, 1.0]

    Attributes:
        rows: of the grid, at least 1.
        cols: of the grid, at least 1.
        weights: (rows * cols, dim), read-only, float32 if given so, else float64.
        topology: "rectangular" or "hexagonal".

    Raises:
        ValueError: the weights have another shape, are not finite or too large to be squared, or there is no such grid.
    """

    rows: int
    cols: int
    weights: Array
    topology: Topology = "rectangular"

    def __post_init__(self) -> None:
        weights = np.array(self.weights, dtype=float_type(self.weights), order="C")
        fits = weights.ndim == 2 and weights.shape[0] == self.grid.nodes and weights.shape[1] > 0
        if not fits or not np.isfinite(weights).all():
            raise ValueError(f"weights of shape {weights.shape} are not {self.rows}×{self.cols} finite vectors")
        check_squarable(weights)
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the constructor's arguments, so that the copy's weights are read-only, too."""
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
        """The grid that the units stand on."""
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
        """Find the best matching unit of x (dim,), argmin ‖x − w‖, in one BLAS call; of equally near ones the first.

        Raises:
            ValueError: x has another length, an infinite component or no known one.
        """
        return int(self.lookup.score(numbers(x)).argmin())

    def bmus(self, vectors: ArrayLike) -> Indices:
        """Find the best matching unit of each row of (n, dim). Shape (n,).

        The same for any number of BLAS threads. Where two runs must agree on ties to the bit, n must agree too.

        Raises:
            ValueError: the rows have another length, an infinite component or no known one.
        """
        return self.lookup.winners(numbers(vectors))

    def best_two(self, vectors: ArrayLike) -> Indices:
        """Find the best and the second-best matching unit of each row of (n, dim). Shape (n, 2).

        Raises:
            ValueError: the map has one unit only; or as `bmus`.
        """
        if self.grid.nodes < 2:
            raise ValueError("a map of one unit has no second-best unit")
        rows = numbers(vectors)
        best_units = np.empty((len(rows), 2), np.intp)
        for chunk, scores in self.lookup.scores(rows):
            best = scores.argmin(axis=1)
            np.put_along_axis(scores, best[:, None], np.inf, axis=1)
            best_units[chunk] = np.stack([best, scores.argmin(axis=1)], axis=1)
        return best_units

    def excess2(self, x: ArrayLike) -> Array:
        """Return each unit's squared distance to x beyond the winner's, d² − d²_min, shape (rows * cols,).

        |x|² cancels, so that the differences stay exact however far x lies from the map.

        Raises:
            ValueError: x has another length, an infinite component or no known one.
        """
        scores = self.lookup.score(numbers(x))[: len(self.weights)]
        scores -= scores[scores.argmin()]
        scores *= 2
        return scores

    def excess2s(self, vectors: ArrayLike) -> Array:
        """Return d² − d²_min of each row of (n, dim) to each unit, shape (n, rows * cols), in the map's precision.

        Raises:
            ValueError: the rows have another length, an infinite component or no known one.
        """
        rows = numbers(vectors)
        excess2 = np.empty((len(rows), self.grid.nodes), self.dtype)
        for chunk, scores in self.lookup.scores(rows):
            np.subtract(scores[:, : self.grid.nodes], scores.min(axis=1, keepdims=True), out=excess2[chunk])
        excess2 *= 2
        return excess2

    def distances2(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return each unit's squared Euclidean distance to x (dim,), shape (rows * cols,).

        Raises:
            ValueError: x has another length, an infinite component or no known one.
        """
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
        """Return each unit's mean distance to its grid neighbours' weights, shape (rows, cols).

        Args:
            neighbours: 8, the default, or 4; on a hexagonal grid 6.

        Raises:
            ValueError: units have no such number of neighbours.
        """
        return measures.u_matrix(self.weights, self.grid, neighbours)

    def hits(self, vectors: ArrayLike) -> Indices:
        """Return how many rows of (n, dim) each unit wins, shape (rows, cols).

        Raises:
            ValueError: as `bmus`.
        """
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
        """The weights, laid out for computing distances to all units at once."""
        return Lookup(self.weights)


def map_arrays(som: Codebook) -> dict[str, Array]:
    """Return the arrays that a file stores of a map, by name."""
    return {"weights": som.planes, "topology": np.array(som.topology)}


def stored_map(file: Mapping[str, Array], kind: type[Map]) -> Map:
    """Make a map of the arrays that `map_arrays` names.

    Raises:
        ValueError, KeyError: the file holds other arrays.
    """
    return kind.of_planes(file["weights"], cast(Topology, str(file["topology"])))
