"""The regions of the second map: which action each unit stands for, and where a region's name goes."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Floats, Indices, Mask


@dataclass(frozen=True, eq=False)
class Regions:
    """The second map divided between the actions.

    Attributes:
        actions: (rows, cols), the index of the action whose neuron has the largest cosine.
        margins: (rows, cols), that cosine less the next largest, relative to the largest margin: 0 to 1.
    """

    actions: Indices
    margins: Floats


def regions(cosines: Floats, rows: int, cols: int) -> Regions:
    """Divide a map by the neurons' cosines for each unit, (rows * cols, actions), two actions at least."""
    ordered = np.sort(cosines, axis=1)
    margins = ordered[:, -1] - ordered[:, -2]
    relative = margins / max(margins.max(), 1e-12)
    return Regions(cosines.argmax(axis=1).reshape(rows, cols), relative.reshape(rows, cols))


def largest_component(mask: Mask) -> Indices:
    """Return row and column of the units of a mask's largest connected component, (n, 2); n = 0 where it is empty.

    Args:
        mask: (rows, cols).
    """
    remaining = {(int(row), int(col)) for row, col in np.argwhere(mask)}
    largest: set[tuple[int, int]] = set()
    while remaining:
        start = next(iter(remaining))
        component, frontier = {start}, [start]
        while frontier:
            row, col = frontier.pop()
            near = {(row - 1, col), (row + 1, col), (row, col - 1), (row, col + 1)} & remaining - component
            component |= near
            frontier += near
        remaining -= component
        largest = max(largest, component, key=len)
    return np.array(sorted(largest), dtype=np.intp).reshape(-1, 2)


def innermost_unit(component: Indices) -> tuple[int, int]:
    """Return row and column of the unit farthest inside a component (n, 2); of equals the one nearest to its mean."""
    members = {(int(row), int(col)) for row, col in component}
    mean = component.mean(axis=0)

    def inwardness(unit: tuple[int, int]) -> tuple[int, float]:
        radius = 0
        while all(
            (unit[0] + down, unit[1] + right) in members
            for down in range(-radius - 1, radius + 2)
            for right in range(-radius - 1, radius + 2)
        ):
            radius += 1
        return radius, -float(np.hypot(*(np.array(unit) - mean)))

    return max(sorted(members), key=inwardness)
