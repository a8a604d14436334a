"""A second opinion beside the maps: ridge regression on random convolutions of a segment's postures.

The convolutions are those of MiniRocket (Dempster, Schmidt and Webb 2021): 84 kernels of nine weights, six of them -1
and three 2, at several dilations, each on the sum of some coordinates. A feature is the share of instants at which a
response exceeds a bias.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from actum.arrays import Array, Mask
from actum.core import steps

INSTANTS = 32
"""Instants that a segment is resampled to: the bits of the numbers that `_packed` returns."""
COORDINATES = 45
"""Of the 15 joints."""
WEIGHTS = 9
"""Of each kernel."""
DILATIONS = (1, 2, 3)
"""Instants between two weights: the widest kernel spans 25."""
KERNELS = np.array(
    [[2 if n in twos else -1 for n in range(WEIGHTS)] for twos in combinations(range(WEIGHTS), 3)], np.float32
)
"""All 84 kernels, (84, 9)."""
LONGEST_REACH = WEIGHTS // 2 * max(DILATIONS)
"""Instants from a kernel's middle to its end."""
FILTERS = len(DILATIONS) * len(KERNELS)
"""Pairs of a dilation and a kernel, kernel after kernel for each dilation."""

Floats32 = NDArray[np.float32]


def resampled(postures: Array) -> Floats32:
    """Return the coordinates of a segment's postures (n, 15, 3) at `INSTANTS` equal steps, (45, INSTANTS).

    Missing coordinates are interpolated over time; those that are never there are 0.
    """
    rows = postures.reshape(len(postures), COORDINATES)
    if np.isnan(rows).any():
        rows = np.nan_to_num(np.stack([_interpolated(column) for column in rows.T], axis=1))
    at = np.linspace(0, len(rows) - 1, INSTANTS)
    before = np.minimum(at.astype(np.intp), max(len(rows) - 2, 0))
    after = np.minimum(before + 1, len(rows) - 1)
    share = (at - before)[:, None]
    return np.ascontiguousarray(((1 - share) * rows[before] + share * rows[after]).T, dtype=np.float32)


def _interpolated(values: Array) -> Array:
    known = np.flatnonzero(~np.isnan(values))
    return values if not len(known) else np.interp(np.arange(len(values)), known, values[known])


@dataclass(frozen=True, eq=False)
class Convolutions:
    """What the filters look at, and the biases that their responses are compared with.

    Attributes:
        coordinates: (FILTERS, 45), 1 where a filter's input contains a coordinate, else 0.
        biases: (FILTERS, biases), as many for each filter.
    """

    coordinates: Floats32
    biases: Floats32

    def responses(self, series: Floats32) -> Floats32:
        """Return the response of each filter at each instant of a series (45, INSTANTS), (FILTERS, INSTANTS)."""
        inputs = (self.coordinates @ series).reshape(len(DILATIONS), len(KERNELS), INSTANTS)
        padded = np.zeros((*inputs.shape[:2], INSTANTS + 2 * LONGEST_REACH), np.float32)
        padded[:, :, LONGEST_REACH : LONGEST_REACH + INSTANTS] = inputs
        windows = sliding_window_view(padded, INSTANTS, axis=2)
        found = np.empty_like(inputs)
        for of_dilation, dilation, responses in zip(windows, DILATIONS, found, strict=True):
            first = LONGEST_REACH - WEIGHTS // 2 * dilation
            weighed = of_dilation[:, first : first + WEIGHTS * dilation : dilation] * KERNELS[:, :, None]
            np.add.reduce(weighed, axis=1, out=responses)
        return found.reshape(FILTERS, INSTANTS)

    def features(self, series: Floats32) -> Floats32:
        """Return the share of the instants at which each response exceeds each of its biases, (FILTERS * biases,)."""
        if steps is not None:
            compiled = np.empty(self.biases.size, np.float32)
            inputs = np.ascontiguousarray(self.coordinates @ series)
            biases = np.ascontiguousarray(self.biases)
            steps.exceeding(inputs, SMALL_KERNELS, DILATED, WEIGHTS, biases, COUNTED_NUMBERS, COUNTS, compiled)
            return compiled
        exceeds = _packed(self.responses(series)[:, None, :] > self.biases[:, :, None])
        shares: Floats32 = np.divide(np.bitwise_count(exceeds & PACKED[:, None]), COUNTS[:, None], dtype=np.float32)
        return shares.ravel()


def _packed(mask: Mask) -> NDArray[np.uint32]:
    """Return a mask (…, INSTANTS) as one number each, (…), whose bits can be counted at once."""
    return np.packbits(mask, axis=-1).view(np.uint32)[..., 0]


def _counted(filter_number: int) -> Mask:
    dilation_number, kernel = divmod(filter_number, len(KERNELS))
    reach = WEIGHTS // 2 * DILATIONS[dilation_number]
    at = np.arange(INSTANTS)
    within: Mask = (reach <= at) & (at < INSTANTS - reach)
    return within if (dilation_number + kernel) % 2 else np.ones(INSTANTS, dtype=bool)


COUNTED = np.stack([_counted(number) for number in range(FILTERS)])
"""At which instants each filter counts, (FILTERS, INSTANTS): every other one only where it lies within the series."""
COUNTS = COUNTED.sum(axis=1, dtype=np.float32)
"""At how many instants each filter counts, (FILTERS,)."""
SMALL_KERNELS, DILATED = KERNELS.astype(np.int8), np.array(DILATIONS, np.int32)
COUNTED_NUMBERS = COUNTED.astype(np.int32)
"""`KERNELS`, `DILATIONS` and `COUNTED` as the compiled steps read them."""
PACKED = _packed(COUNTED)
"""`COUNTED` as bits, (FILTERS,)."""


@dataclass(frozen=True, eq=False)
class SecondOpinion:
    """Linear scores of the actions on the features of convolutions: featuresᵀ axes + offsets.

    Attributes:
        convolutions: the features.
        axes: (features, actions).
        offsets: (actions,).
        weight: of these scores beside those of the maps, which have weight 1.
    """

    convolutions: Convolutions
    axes: Floats32
    offsets: Floats32
    weight: float

    def blended(self, scores: Floats32, features: Floats32) -> Floats32:
        """Return the weighted mean of the discriminants' scores (actions,) and this opinion's on features."""
        own = features @ self.axes + self.offsets
        return ((scores + self.weight * own) / (1 + self.weight)).astype(np.float32)
