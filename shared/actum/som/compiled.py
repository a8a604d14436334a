"""The kernel of sequential training, compiled; its arguments are those of `actum.som.kernel.adapt_in_numpy`.

The weights are kept as (dim, stride), so that every loop runs along memory and fills vector registers. One pass moves
the weights towards the input of this step and adds up their distances to that of the next, which halves the traffic
between cache and core. Nothing is reordered: each sum is taken component after component, as in NumPy.
"""

from collections.abc import Callable
from functools import cache
from math import isnan
from typing import TypeVar, cast

import numpy as np
from numba import njit

from actum.som.kernel import Array, Kernel

Function = TypeVar("Function", bound=Callable[..., object])

LANES = 16
"""Units of the map on which the kernel is tried out: real maps are padded to multiples of it."""


def _compiled(function: Function) -> Function:
    return cast(Function, njit(function, error_model="numpy", nogil=True))


@cache
def compiled_kernel() -> Kernel:
    """Return the compiled kernel; its machine code is cached on disk where Numba finds a place to write to."""
    try:
        kernel: Kernel = njit(_adapt, error_model="numpy", nogil=True, cache=True)
        for dtype in (np.float32, np.float64):  # compile it now, so that an error of writing the cache is raised here
            one = np.ones((1, 1), dtype)
            kernel(np.zeros((1, LANES), dtype), one, one, one)
    except (RuntimeError, OSError):
        return _compiled(_adapt)
    return kernel


def _adapt(weights: Array, inputs: Array, over_rows: Array, over_cols: Array) -> None:
    """Take all steps; between two steps the weights are read once, to adapt them and to measure them."""
    nodes = over_rows.shape[1] * over_cols.shape[1]
    distances2, neighbourhood, scratch = np.zeros_like(weights[0]), np.zeros_like(weights[0]), np.zeros_like(weights[0])
    _measure(weights, inputs[0], distances2)
    last = len(inputs) - 1
    for step in range(last):
        winner = _first_least(distances2, nodes, scratch)
        _centre_on(winner, over_rows[step], over_cols[step], scratch, neighbourhood)
        _pull_and_measure(weights, inputs[step], neighbourhood, inputs[step + 1], distances2)
    winner = _first_least(distances2, nodes, scratch)
    _centre_on(winner, over_rows[last], over_cols[last], scratch, neighbourhood)
    _pull(weights, inputs[last], neighbourhood)


@_compiled
def _first_least(values: Array, count: int, least: Array) -> int:
    """Return the first index of the least of `count` values; the least is found by halving, many values at a time."""
    left = (count + 1) // 2
    least[count - left : left] = values[count - left : left]
    for j in range(count - left):
        least[j] = values[j] if values[j] <= values[j + left] else values[j + left]
    while left > 1:
        half = (left + 1) // 2
        for j in range(left - half):
            least[j] = least[j] if least[j] <= least[j + half] else least[j + half]
        left = half
    for j in range(count):
        if values[j] == least[0]:
            return j
    return 0


@_compiled
def _centre_on(winner: int, row_gauss: Array, col_gauss: Array, along: Array, out: Array) -> None:
    """Set out (stride,) to α G of every unit: the product of a Gaussian over rows and one over columns."""
    cols = len(col_gauss)
    row, col = divmod(winner, cols)
    for c in range(cols):
        along[c] = col_gauss[abs(c - col)]
    for r in range(len(row_gauss)):
        across = row_gauss[abs(r - row)]
        for c in range(cols):
            out[r * cols + c] = across * along[c]


@_compiled
def _measure(weights: Array, x: Array, distances2: Array) -> None:
    """Set distances2 (stride,) to the squared distances of x (dim,) to all units."""
    distances2[:] = 0
    for d in range(len(x)):
        if not isnan(x[d]):
            _measure_one(weights[d], x[d], distances2)


@_compiled
def _pull(weights: Array, x: Array, neighbourhood: Array) -> None:
    """Move the weights towards x by α G, the neighbourhood (stride,)."""
    for d in range(len(x)):
        if not isnan(x[d]):
            _pull_one(weights[d], x[d], neighbourhood)


@_compiled
def _pull_and_measure(weights: Array, x: Array, neighbourhood: Array, following: Array, distances2: Array) -> None:
    """Pull the weights towards x, then measure their distances to the following input."""
    distances2[:] = 0
    d = 0
    if not np.isnan(x).any() and not np.isnan(following).any():
        while d + 3 < len(x):
            _pull_and_measure_four(weights[d : d + 4], x[d:], neighbourhood, following[d:], distances2)
            d += 4
    while d < len(x):
        if not isnan(x[d]):
            _pull_one(weights[d], x[d], neighbourhood)
        if not isnan(following[d]):
            _measure_one(weights[d], following[d], distances2)
        d += 1


@_compiled
def _pull_one(row: Array, x: float, neighbourhood: Array) -> None:
    for j in range(len(row)):
        row[j] += (x - row[j]) * neighbourhood[j]


@_compiled
def _measure_one(row: Array, x: float, distances2: Array) -> None:
    for j in range(len(row)):
        difference = x - row[j]
        distances2[j] += difference * difference


@_compiled
def _pull_and_measure_four(four: Array, x: Array, neighbourhood: Array, following: Array, distances2: Array) -> None:
    """Do four components at once, with the neighbourhood and the sums read only once."""
    row0, row1, row2, row3 = four[0], four[1], four[2], four[3]
    x0, x1, x2, x3 = x[0], x[1], x[2], x[3]
    y0, y1, y2, y3 = following[0], following[1], following[2], following[3]
    for j in range(len(neighbourhood)):
        share = neighbourhood[j]
        row0[j] += (x0 - row0[j]) * share
        row1[j] += (x1 - row1[j]) * share
        row2[j] += (x2 - row2[j]) * share
        row3[j] += (x3 - row3[j]) * share
        e0, e1, e2, e3 = y0 - row0[j], y1 - row1[j], y2 - row2[j], y3 - row3[j]
        distances2[j] = distances2[j] + e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3
