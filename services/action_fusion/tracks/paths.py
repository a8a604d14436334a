"""Paths: where something is at other stamps than the known ones, and within which bounds it stays."""

import numpy as np

from actum.arrays import Array
from actum.core import steps


def interpolated(at_ns: Array, stamps_ns: Array, positions_m: Array) -> Array:
    """Interpolate a path (n, 3) at stamps (p,) linearly, constant beyond both ends; return positions (p, 3)."""
    if steps is None:
        return np.stack([np.interp(at_ns, stamps_ns, axis) for axis in positions_m.T], axis=1)
    positions = np.empty((len(at_ns), 3))
    steps.interpolated(at_ns, stamps_ns, positions_m, positions)
    return positions


def bounds_m(positions_m: Array) -> Array:
    """Return the least and the greatest coordinates (2, 3) of positions (n, 3), one at least."""
    if steps is None:
        return np.stack([positions_m.min(axis=0), positions_m.max(axis=0)])
    bounds = np.empty((2, 3))
    steps.bounds(positions_m, bounds)
    return bounds
