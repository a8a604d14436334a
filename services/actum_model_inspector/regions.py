"""Which action each place of the second map stands for, and where the name of an action goes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som.grid import Grid

Floats = NDArray[Any]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Regions:
    """The second map divided between the actions.

    Attributes:
        actions: (rows, cols), the action whose neuron answers most.
        decided: (rows, cols), by how much it does before the next, 1 where that is most, 0 where they are equal.
    """

    actions: Indices
    decided: Floats


def regions(answers: Floats, grid: Grid) -> Regions:
    """Divide the map by the neurons' cosines at each unit (units, actions), two actions at least."""
    ordered = np.sort(answers, axis=1)
    lead = ordered[:, -1] - ordered[:, -2]
    shape = grid.rows, grid.cols
    return Regions(answers.argmax(axis=1).reshape(shape), (lead / max(lead.max(), 1e-12)).reshape(shape))


def largest_component(own: NDArray[np.bool_]) -> Indices:
    """Return row and column of the units of the largest connected patch of a mask, (n, 2), n = 0 where it is empty."""
    left = {(int(row), int(col)) for row, col in np.argwhere(own)}
    largest: set[tuple[int, int]] = set()
    while left:
        patch = _patch_at(next(iter(left)), left)
        left -= patch
        largest = max(largest, patch, key=len)
    return np.array(sorted(largest), dtype=np.intp).reshape(-1, 2)


def centre(patch: Indices) -> tuple[int, int]:
    """Return the unit of a patch that lies deepest inside it; of equals the one nearest to its mean."""
    members = {(int(row), int(col)) for row, col in patch}
    mean = patch.mean(axis=0)

    def nearness(unit: tuple[int, int]) -> tuple[int, float]:
        return _depth(unit, members), -float(np.hypot(*(np.array(unit) - mean)))

    return max(sorted(members), key=nearness)


def _patch_at(start: tuple[int, int], members: set[tuple[int, int]]) -> set[tuple[int, int]]:
    found, front = {start}, [start]
    while front:
        row, col = front.pop()
        near = {(row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)} & members - found
        found |= near
        front += near
    return found


def _depth(unit: tuple[int, int], members: set[tuple[int, int]]) -> int:
    """Return the radius of the largest square about a unit that lies within the patch."""
    radius = 0
    while all(
        (unit[0] + down, unit[1] + right) in members
        for down in range(-radius - 1, radius + 2)
        for right in range(-radius - 1, radius + 2)
    ):
        radius += 1
    return radius
