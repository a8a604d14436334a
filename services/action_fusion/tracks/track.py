"""A track: where a hand or an object was at any stamp, and within which bounds it stayed."""

from functools import cached_property

import numpy as np

from actum.arrays import Array
from actum.core import steps


class Track:
    """Positions `positions_m` (n, 3) at stamps `stamps_ns` (n,), rising, in the camera frame."""

    stamps_ns: Array
    positions_m: Array

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate positions (p, 3) at stamps (p,) linearly, constant beyond both ends."""
        if steps is None:
            return np.stack([np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T], axis=1)
        positions_m = np.empty((len(stamps_ns), 3))
        steps.interpolated(stamps_ns, self.stamps_ns, self.positions_m, positions_m)
        return positions_m

    @cached_property
    def bounds_m(self) -> Array:
        """The least and the greatest coordinates (2, 3) of the positions."""
        return bounds_m(self.positions_m)


def bounds_m(positions_m: Array) -> Array:
    """Return the least and the greatest coordinates (2, 3) of positions (n, 3), one at least."""
    if steps is None:
        return np.stack([positions_m.min(axis=0), positions_m.max(axis=0)])
    bounds = np.empty((2, 3))
    steps.bounds(positions_m, bounds)
    return bounds
