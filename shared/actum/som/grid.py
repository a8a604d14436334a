"""The grid that the units of a map stand on: positions, neighbours, and the Gaussian neighbourhood."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Topology = Literal["rectangular", "hexagonal"]

_REACH2 = {"rectangular": {8: 2.0, 4: 1.0}, "hexagonal": {6: 1.0}}
"""Squared grid distance to the farthest neighbour, by the number of neighbours; the first number is the usual one."""
_ROUNDING = 1e-9
"""Slack in squared grid units: positions on hexagonal grids are irrational."""


@dataclass(frozen=True)
class Grid:
    """`rows` × `cols` units; unit k stands at row k // cols, column k % cols.

    On a hexagonal grid every odd row is shifted right by half a unit and rows are √3/2 apart ("odd-r"), so that each
    unit inside has six neighbours at distance 1.

    >>> grid = Grid(2, 2, "hexagonal")
    >>> grid.nodes, grid.positions.round(2).tolist()
    (4, [[0.0, 0.0], [0.0, 1.0], [0.87, 0.5], [0.87, 1.5]])
    >>> grid.are_neighbours(np.array([0, 0]), np.array([2, 3])).tolist()
    [True, False]

    Raises:
        ValueError: there is no unit, or no such topology.
    """

    rows: int
    cols: int
    topology: Topology = "rectangular"

    def __post_init__(self) -> None:
        if self.topology not in get_args(Topology):
            raise ValueError(f"{self.topology!r} is not a topology: use {', '.join(get_args(Topology))}")
        if self.rows < 1 or self.cols < 1:
            raise ValueError(f"a grid of {self.rows}×{self.cols} has no units: use at least 1×1")

    @property
    def nodes(self) -> int:
        """How many units there are."""
        return self.rows * self.cols

    @cached_property
    def coordinates(self) -> NDArray[np.float64]:
        """Row and column of each unit, read-only, shape (nodes, 2)."""
        return _read_only(np.stack(np.divmod(np.arange(self.nodes), self.cols), axis=1).astype(np.float64))

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Centre of each unit as (down, right) in grid units, read-only, shape (nodes, 2)."""
        row, col = self.coordinates.T
        right = col + np.tile(self.shifts[:, None], self.cols).ravel() / 2
        return _read_only(np.stack([row * self.row_spacing, right], axis=1))

    @property
    def row_spacing(self) -> float:
        """Distance between two rows in grid units."""
        return 1.0 if self.topology == "rectangular" else 0.75**0.5

    @property
    def substeps(self) -> int:
        """Steps into which a column is divided: all units stand at multiples of 1 / substeps along a row."""
        return 1 if self.topology == "rectangular" else 2

    @cached_property
    def shifts(self) -> NDArray[np.intp]:
        """How far each row is shifted right, in substeps, shape (rows,)."""
        return np.arange(self.rows) % 2 * (self.substeps - 1)

    def row_gaussians(self, radii: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return exp(−y² / 2 radius²) for units 0, 1, … rows apart and radii (n,), shape (n, rows)."""
        distance2 = np.arange(self.rows, dtype=np.float64) ** 2 * (1.0 if self.topology == "rectangular" else 0.75)
        return np.exp(distance2 * (-0.5 / radii[:, None] ** 2))

    def col_gaussians(self, radii: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return exp(−x² / 2 radius²) for units 0, 1, … substeps of a column apart, radii (n,): (n, substeps * cols).

        The Gaussian of the distance on the grid is the product of one along the rows and one along the columns.
        """
        distance2 = (np.arange(self.substeps * self.cols) / self.substeps) ** 2
        return np.exp(distance2 * (-0.5 / radii[:, None] ** 2))

    def are_neighbours(
        self, first: NDArray[np.intp], second: NDArray[np.intp], neighbours: int | None = None
    ) -> NDArray[np.bool_]:
        """Tell of each pair of units whether they are neighbours, shape (n,).

        Args:
            first: (n,), units by number.
            second: (n,), the other unit of each pair.
            neighbours: how many a unit has: 8, the default, or 4; on a hexagonal grid 6.

        Raises:
            ValueError: units have no such number of neighbours.
        """
        apart = self.positions[first] - self.positions[second]
        near: NDArray[np.bool_] = np.square(apart).sum(axis=-1) <= self._reach2(neighbours) + _ROUNDING
        return near

    def edges(self, neighbours: int | None = None) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the first and the second units of all ordered pairs of neighbours, both of shape (pairs,).

        Raises:
            ValueError: units have no such number of neighbours.
        """
        row, col = np.divmod(np.arange(self.nodes), self.cols)
        firsts, seconds = [], []
        for down, right in product((-1, 0, 1), repeat=2):
            if down == right == 0:
                continue
            to_row, to_col = row + down, col + right
            first = np.flatnonzero((to_row >= 0) & (to_row < self.rows) & (to_col >= 0) & (to_col < self.cols))
            second = first + down * self.cols + right
            near = self.are_neighbours(first, second, neighbours)
            firsts.append(first[near])
            seconds.append(second[near])
        return np.concatenate(firsts), np.concatenate(seconds)

    def _reach2(self, neighbours: int | None) -> float:
        known = _REACH2[self.topology]
        count = next(iter(known)) if neighbours is None else neighbours
        if count not in known:
            possible = " or ".join(map(str, known))
            raise ValueError(f"a unit of a {self.topology} grid has {possible} neighbours, not {count}")
        return known[count]


def _read_only(array: NDArray[np.float64]) -> NDArray[np.float64]:
    array.setflags(write=False)
    return array
