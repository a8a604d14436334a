"""How far a person moves in a segment: what distinguishes an action from standing still."""

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.node import SECOND_NS

AVERAGED_NS = SECOND_NS // 4
"""Postures are averaged over this long (ns): longer than a jump of a joint, shorter than any action."""


def movement_m(stamps_ns: NDArray[np.int64], postures: Array) -> float:
    """Return the distance between the two most different postures of a segment (m).

    A posture is a mean over a quarter of a second. The distance between two is the root mean square over the two joints
    that are farthest apart: a hand moves with its elbow, while jitter moves each joint by itself. Unlike the length of
    a path, it grows with neither the number of frames nor their jitter.

    Args:
        stamps_ns: (n,), rising.
        postures: (n, 15, 3), low-passed, metres, NaN where a joint is missing.
    """
    means = _averaged(stamps_ns, postures)
    farthest_m2 = second_m2 = np.zeros((len(means), len(means)))
    for joint in means.swapaxes(0, 1):
        apart_m2 = np.nan_to_num(((joint[:, None] - joint) ** 2).sum(axis=2))
        second_m2 = np.maximum(second_m2, np.minimum(farthest_m2, apart_m2))
        farthest_m2 = np.maximum(farthest_m2, apart_m2)
    return float(np.sqrt((farthest_m2 + second_m2).max() / 2))


def _averaged(stamps_ns: NDArray[np.int64], postures: Array) -> Array:
    """Return the mean posture of each interval (intervals, 15, 3), NaN where a joint is missing all the while."""
    first = np.unique((stamps_ns - stamps_ns[0]) // AVERAGED_NS, return_index=True)[1]
    known = np.add.reduceat(~np.isnan(postures), first, axis=0, dtype=np.float64)
    sums: Array = np.add.reduceat(np.nan_to_num(postures), first, axis=0)
    means: Array = np.divide(sums, known, out=np.full_like(sums, np.nan), where=known > 0)
    return means
