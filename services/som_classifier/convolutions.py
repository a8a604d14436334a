"""A second opinion beside the maps: ridge regression on random convolutions of a segment's postures.

The convolutions are those of MiniRocket (Dempster, Schmidt and Webb 2021): 84 kernels of nine weights, six of them -1
and three 2, at several dilations, each on the sum of some coordinates or, as in MultiRocket (Tan et al. 2022), on its
differences from instant to instant. A feature is the share of instants at which a response exceeds a bias.

Coordinates are those of the joints, and of some joints from others, with their distances: sums of coordinates alone do
not show how far a hand is from the head.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from actum.arrays import Array, Mask
from actum.core import steps
from actum.skeletons import INDEX, JOINTS

INSTANTS = 32
"""Instants that a segment is resampled to: the bits of the numbers that `_packed` returns."""
_FROM_OTHERS = {
    "left_hand": ("head", "right_hand", "left_shoulder", "right_shoulder", "left_hip"),
    "right_hand": ("head", "right_shoulder", "left_shoulder", "right_hip"),
    "left_foot": ("left_hip", "right_foot"),
    "right_foot": ("right_hip",),
}
_PAIRS = np.array([(INDEX[joint], INDEX[other]) for joint, others in _FROM_OTHERS.items() for other in others])
"""Joints, and those that they are also measured from, (pairs, 2)."""
_PAIRS_32 = _PAIRS.astype(np.int32)
COORDINATES = 3 * len(JOINTS) + 4 * len(_PAIRS)
"""Of the 15 joints, then of the first joint of each pair from the other one, then their distances."""
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
PLAIN_FILTERS = len(DILATIONS) * len(KERNELS)
"""Pairs of a dilation and a kernel, kernel after kernel for each dilation."""
FILTERS = 2 * PLAIN_FILTERS
"""The same pairs twice: filters of sums of coordinates, then filters of their differences."""

Floats32 = NDArray[np.float32]


def resampled(stamps_ns: NDArray[np.int64], postures: Array) -> Floats32:
    """Return the coordinates of a segment at `INSTANTS` equal steps of time, (COORDINATES, INSTANTS).

    Missing coordinates of joints are interpolated from frame to frame; those that are never there are 0.

    Args:
        stamps_ns: (n,), rising.
        postures: (n, 15, 3), at these stamps.
    """
    if steps is not None:
        series, in_turn = np.empty((COORDINATES, INSTANTS), np.float32), np.ascontiguousarray(postures)
        if steps.resampled(stamps_ns, in_turn, _PAIRS_32, INSTANTS, series):
            return series
    rows = postures.reshape(len(postures), -1)
    if np.isnan(rows).any():
        rows = np.nan_to_num(np.stack([_interpolated(column) for column in rows.T], axis=1))
    at = np.interp(np.linspace(stamps_ns[0], stamps_ns[-1], INSTANTS), stamps_ns, np.arange(len(rows)))
    before = np.minimum(at.astype(np.intp), max(len(rows) - 2, 0))
    after = np.minimum(before + 1, len(rows) - 1)
    share = (at - before)[:, None]
    joints = ((1 - share) * rows[before] + share * rows[after]).T.astype(np.float32)
    positions = joints.reshape(len(JOINTS), 3, INSTANTS)
    apart = positions[_PAIRS[:, 0]] - positions[_PAIRS[:, 1]]
    return np.concatenate([joints, apart.reshape(-1, INSTANTS), np.sqrt(np.square(apart).sum(axis=1))])


def _interpolated(values: Array) -> Array:
    known = np.flatnonzero(~np.isnan(values))
    return values if not len(known) else np.interp(np.arange(len(values)), known, values[known])


@dataclass(frozen=True, eq=False)
class Convolutions:
    """What the filters look at, and the biases that their responses are compared with.

    Attributes:
        coordinates: (FILTERS, COORDINATES), 1 where a filter's input contains a coordinate, else 0.
        biases: (FILTERS, biases), as many for each filter.
    """

    coordinates: Floats32
    biases: Floats32

    def responses(self, series: Floats32) -> Floats32:
        """Return each filter's response at each instant of a series (COORDINATES, INSTANTS), (FILTERS, INSTANTS)."""
        return _responses(self._inputs(series))

    def responses_each(self, series: Sequence[Floats32]) -> Floats32:
        """Return each filter's response to a series of its own, (FILTERS, INSTANTS)."""
        return _responses(np.stack([self._inputs(own)[number] for number, own in enumerate(series)]))

    def features(self, series: Floats32) -> Floats32:
        """Return the share of the instants at which each response exceeds each of its biases, (FILTERS * biases,)."""
        if steps is not None:
            compiled = np.empty(self.biases.size, np.float32)
            inputs, biases = self._summed(series), np.ascontiguousarray(self.biases)
            steps.exceeding(
                inputs, PLAIN_FILTERS, SMALL_KERNELS, DILATED, WEIGHTS, biases, COUNTED_NUMBERS, COUNTS, compiled
            )
            return compiled
        exceeds = _packed(self.responses(series)[:, None, :] > self.biases[:, :, None])
        shares: Floats32 = np.divide(np.bitwise_count(exceeds & PACKED[:, None]), COUNTS[:, None], dtype=np.float32)
        return shares.ravel()

    def _inputs(self, series: Floats32) -> Floats32:
        """Return what each filter is applied to: the sum of its coordinates, or by how much that has just changed."""
        inputs = self._summed(series)
        changing = inputs[PLAIN_FILTERS:]
        changing[:, 1:] = np.diff(changing)
        changing[:, 0] = 0.0
        return inputs

    def _summed(self, series: Floats32) -> Floats32:
        """Return the sum of each filter's coordinates, (FILTERS, INSTANTS)."""
        summed: Floats32 = np.ascontiguousarray(self.coordinates @ series)
        return summed


def _responses(inputs: Floats32) -> Floats32:
    """Return each filter's response to its input, both (FILTERS, INSTANTS)."""
    inputs = inputs.reshape(len(DILATED), len(KERNELS), INSTANTS)
    padded = np.zeros((*inputs.shape[:2], INSTANTS + 2 * LONGEST_REACH), np.float32)
    padded[:, :, LONGEST_REACH : LONGEST_REACH + INSTANTS] = inputs
    windows = sliding_window_view(padded, INSTANTS, axis=2)
    found = np.empty_like(inputs)
    for of_dilation, dilation, responses in zip(windows, DILATED.tolist(), found, strict=True):
        first = LONGEST_REACH - WEIGHTS // 2 * dilation
        weighed = of_dilation[:, first : first + WEIGHTS * dilation : dilation] * KERNELS[:, :, None]
        np.add.reduce(weighed, axis=1, out=responses)
    return found.reshape(FILTERS, INSTANTS)


def _packed(mask: Mask) -> NDArray[np.uint32]:
    """Return a mask (…, INSTANTS) as one number each, (…), whose bits can be counted at once."""
    return np.packbits(mask, axis=-1).view(np.uint32)[..., 0]


def _counted(filter_number: int) -> Mask:
    dilation_number, kernel = divmod(filter_number % PLAIN_FILTERS, len(KERNELS))
    reach = WEIGHTS // 2 * DILATIONS[dilation_number]
    at = np.arange(INSTANTS)
    within: Mask = (reach <= at) & (at < INSTANTS - reach)
    return within if (dilation_number + kernel) % 2 else np.ones(INSTANTS, dtype=bool)


COUNTED = np.stack([_counted(number) for number in range(FILTERS)])
"""At which instants each filter counts, (FILTERS, INSTANTS): every other one only where it lies within the series."""
COUNTS = COUNTED.sum(axis=1, dtype=np.float32)
"""At how many instants each filter counts, (FILTERS,)."""
SMALL_KERNELS, DILATED = KERNELS.astype(np.int8), np.tile(np.array(DILATIONS, np.int32), 2)
COUNTED_NUMBERS = COUNTED.astype(np.int32)
"""`KERNELS`, the dilation of each 84 filters, and `COUNTED`, as the compiled steps read them."""
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
