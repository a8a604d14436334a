"""The codebook of a map: weights on a grid, to be looked up and measured, but not trained."""

from dataclasses import dataclass, fields
from functools import cached_property
from itertools import product
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som.inputs import check_squarable, float_type, numbers, some_rows
from actum.som.lookup import Lookup

Array = NDArray[Any]
Indices = NDArray[np.intp]
Map = TypeVar("Map", bound="Codebook")

_FARTHEST2 = {8: 2, 4: 1}
"""Squared distance on the grid to the farthest neighbour, by the number of neighbours."""


@dataclass(frozen=True, eq=False)
class Codebook:
    """A weight vector for each unit of a grid; unit k stands at row k // cols, column k % cols.

    Inputs are converted to the weights' precision. Components of an input that are NaN count as missing: they are
    left out of the distance to every unit, and the squared distance is scaled up by dim / known. As distances are
    squared, single precision tells apart only what differs by more than 1e-19.

    >>> codebook = Codebook(1, 3, [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]])
    >>> codebook.bmu([0.9, 0.2]), codebook.bmus([[0.0, 1.9], [np.nan, 0.1]]).tolist()
    (1, [2, 0])
    >>> codebook.excess2([0.0, 1.0]).tolist()
    [0.0, 1.0, 0.0]

    Attributes:
        rows: of the grid, at least 1.
        cols: of the grid, at least 1.
        weights: (rows * cols, dim), read-only, float32 if given so, else float64.

    Raises:
        ValueError: the weights have another shape, are not finite or too large to be squared, or there is no unit.
    """

    rows: int
    cols: int
    weights: Array

    def __post_init__(self) -> None:
        weights = np.array(self.weights, dtype=float_type(self.weights), order="C")
        fits = weights.ndim == 2 and weights.shape[0] == self.rows * self.cols and weights.shape[1] > 0
        if not fits or min(self.rows, self.cols) < 1 or not np.isfinite(weights).all():
            raise ValueError(
                f"the weights have the shape {weights.shape}, but a grid of {self.rows}×{self.cols} units needs "
                f"{self.rows * self.cols} rows of finite numbers, one row for each unit"
            )
        check_squarable(weights)
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the constructor's arguments, so that the copy's weights are read-only, too."""
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    @classmethod
    def of_planes(cls, planes: ArrayLike) -> Self:
        """Make a map of its component planes (rows, cols, dim).

        Raises:
            ValueError: they have another shape or are not finite.
        """
        stacked = np.asarray(planes)
        if stacked.ndim != 3:
            raise ValueError(
                f"the component planes have the shape {stacked.shape}: give an array of the shape (rows, cols, "
                "components)"
            )
        rows, cols, dim = stacked.shape
        return cls(rows, cols, stacked.reshape(rows * cols, dim))

    @property
    def dim(self) -> int:
        """The length of an input vector."""
        return int(self.weights.shape[1])

    @property
    def dtype(self) -> np.dtype[np.floating]:
        """The precision that the map is kept in and computes in."""
        return self.weights.dtype

    @cached_property
    def coordinates(self) -> NDArray[np.float64]:
        """Row and column of each unit, read-only, shape (rows * cols, 2)."""
        coordinates = unit_coordinates(self.rows, self.cols)
        coordinates.setflags(write=False)
        return coordinates

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
        if len(self.weights) < 2:
            raise ValueError(
                "the map has only one unit, so there is no second-best unit: use a map of at least two units"
            )
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
        excess2 = np.empty((len(rows), len(self.weights)), self.dtype)
        for chunk, scores in self.lookup.scores(rows):
            np.subtract(scores[:, : len(self.weights)], scores.min(axis=1, keepdims=True), out=excess2[chunk])
        excess2 *= 2
        return excess2

    def quantization_error(self, vectors: ArrayLike) -> float:
        """Return the mean distance of the rows of (n, dim) to their winners.

        Raises:
            ValueError: there is no row.
        """
        rows = some_rows(vectors)
        squares = np.square(np.subtract(rows, self.weights[self.bmus(rows)], dtype=np.float64))
        known = self.dim - np.isnan(squares).sum(axis=1)
        return float(np.sqrt(np.nansum(squares, axis=1) * (self.dim / known)).mean())

    def topographic_error(self, vectors: ArrayLike, neighbours: int = 8) -> float:
        """Return the share of the rows of (n, dim) whose two best units are no neighbours on the grid.

        Args:
            vectors: the inputs.
            neighbours: how many a unit has, 8 or 4.

        Raises:
            ValueError: there is no row, no second unit, or no such number of neighbours.
        """
        if neighbours not in _FARTHEST2:
            raise ValueError(f"the argument 'neighbours' is {neighbours}: use {' or '.join(map(str, _FARTHEST2))}")
        first, second = self.coordinates[self.best_two(some_rows(vectors)).T]
        return float((np.square(first - second).sum(axis=1) > _FARTHEST2[neighbours]).mean())

    def u_matrix(self) -> NDArray[np.float64]:
        """Return each unit's mean distance to the weights of its up to eight neighbours, shape (rows, cols).

        It is 0 for a unit without any.
        """
        padded = np.pad(self.planes.astype(np.float64), ((1, 1), (1, 1), (0, 0)), constant_values=np.nan)
        shifted = [
            padded[down : down + self.rows, right : right + self.cols] for down, right in product(range(3), repeat=2)
        ]
        distances = np.linalg.norm(shifted - self.planes, axis=3)
        counts = np.isfinite(distances).sum(axis=0) - 1  # at no shift it is the unit itself, at a distance of 0
        means: NDArray[np.float64] = np.nansum(distances, axis=0) / np.maximum(counts, 1)
        return means

    @cached_property
    def lookup(self) -> Lookup:
        """The weights, laid out for computing distances to all units at once."""
        return Lookup(self.weights)


def unit_coordinates(rows: int, cols: int) -> NDArray[np.float64]:
    """Return row and column of each unit of a grid, shape (rows * cols, 2)."""
    return np.stack(np.divmod(np.arange(rows * cols), cols), axis=1).astype(np.float64)
