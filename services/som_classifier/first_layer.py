"""The first layer of the default recogniser: maps of postures, velocities and arms, each with a soft activity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Indices, has_unknown
from actum.core import steps
from actum.skeletons import INDEX, JOINTS
from actum.som import Som, Together
from som_classifier.handedness import ACROSS, OPPOSITE
from som_classifier.pyramid import SCALE, Sums, running_sums

VELOCITY_WEIGHT = 3.0
"""Weight of velocities against positions in the arm map's input: both then have about the same variance."""
SMALLEST_ERROR2 = 6e-5
"""Smaller squared quantization errors (m²) count as this, 2 mm a joint on average: the logarithm of 0 is infinite."""

BLOCK = 32
"""Units whose weights lie together for the compiled step: as many sums as fit into a processor's registers."""
_SIZE = 3 * len(JOINTS)
_ARM = np.arange(3 * INDEX["right_elbow"], 3 * INDEX["right_hand"] + 3)
_SHOULDER = np.tile(np.arange(3), 2) + 3 * INDEX["right_shoulder"]
_ARM_COLUMNS = np.concatenate([_ARM, _ARM + _SIZE])
"""Columns of the right elbow and hand in a row of `frame_inputs`, positions and then velocities: (12,)."""
_SHOULDER_COLUMNS = np.concatenate([_SHOULDER, _SHOULDER + _SIZE])
"""The right shoulder's columns, from which those of elbow and hand are measured: (12,)."""
_MIRROR = np.concatenate([(3 * OPPOSITE[:, None] + np.arange(3)).ravel() + start for start in (0, _SIZE)])
_SIGNS = np.tile(ACROSS, 2 * len(JOINTS))


def frame_inputs(postures: Floats, velocities: Floats) -> Floats:
    """Return postures and velocities (n, 15, 3) as rows of all their components, shape (n, 90)."""
    return np.concatenate([postures.reshape(-1, _SIZE), velocities.reshape(-1, _SIZE)], axis=1)


def mirrored_inputs(rows: Floats) -> Floats:
    """Return the `frame_inputs` (…, 90) of the actor's mirror image, same shape."""
    inputs: Floats = rows[..., _MIRROR] * _SIGNS
    return inputs


class Channel(NamedTuple):
    """A block of a frame's activity: the name of the map that answers, and whether it is shown the mirror image."""

    map: str
    mirrored: bool = False


class Inputs:
    """What a map is shown: columns of `frame_inputs`, or their differences from others, times factors.

    The compiled steps compute it from the same columns and factors.

    Args:
        columns: the columns, (dim,).
        less: the columns that are subtracted from them, (dim,); None where none are.
        factors: what the differences are multiplied by, (dim,); 1 where nothing is subtracted.
    """

    def __init__(self, columns: slice | Indices, less: Indices | None = None, factors: Floats | None = None) -> None:
        self._columns, self._less = columns, less
        self._factors = np.ones(1) if factors is None else factors
        self.size = len(self.compiled[0])

    def of(self, rows: Floats) -> Floats:
        """Return the inputs (n, dim) for rows of `frame_inputs` (n, 90)."""
        if self._less is None:
            return rows[:, self._columns]
        inputs: Floats = (rows[:, self._columns] - rows[:, self._less]) * self._factors
        return inputs

    @property
    def compiled(self) -> tuple[Indices, Indices, Floats]:
        """The columns, those that are subtracted, -1 where none is, and the factors, (dim,) each."""
        columns = np.arange(2 * _SIZE)[self._columns]
        less = np.full(len(columns), -1) if self._less is None else self._less
        return columns, less, np.broadcast_to(self._factors, len(columns))


MAP_INPUTS: Mapping[str, Inputs] = {
    "postures": Inputs(slice(_SIZE)),
    "velocities": Inputs(slice(_SIZE, 2 * _SIZE)),
    "arms": Inputs(_ARM_COLUMNS, _SHOULDER_COLUMNS, np.repeat([1.0, VELOCITY_WEIGHT], len(_ARM))),
}
"""The maps by name, in the order in which they are trained, and what each is shown of a frame.

The arm map is shown positions and velocities of right elbow and hand relative to the shoulder."""
MIRRORED = _MIRROR.astype(np.int32).tobytes(), _SIGNS.tobytes()
"""For each column of `frame_inputs` the one of which it is the mirror image, and the sign. Of this and all constants
the compiled steps read the bytes: to take the buffer of an array costs more."""
ACTING_ARM, OTHER_ARM = Channel("arms"), Channel("arms", mirrored=True)
CHANNELS = (Channel("postures"), Channel("velocities"), ACTING_ARM, OTHER_ARM)
"""The blocks of a frame's activity, in this order, that of postures first; the arm map answers for both arms."""


@dataclass(frozen=True, eq=False)
class FirstMaps:
    """The first layer: the maps of `MAP_INPUTS`, each with a soft activity.

    Attributes:
        maps: by name; all have the same number of units.
        contrasts: of each map's soft activity, by the map's name, in the unit of its squared distances.
        arm_shares: the sum of the arm map's activity for the acting arm, and for the other one; for each of the other
            maps the sum is 1.
    """

    maps: Mapping[str, Som]
    contrasts: Mapping[str, float]
    arm_shares: tuple[float, float]

    @property
    def postures(self) -> Som:
        """The map of postures."""
        return self.maps["postures"]

    @cached_property
    def units(self) -> int:
        """The length of a frame's activity vector: as many units as a map has, for each channel."""
        return len(CHANNELS) * len(self.postures.weights)

    def activities(self, postures: Floats, velocities: Floats) -> Floats:
        """Return the activities of many frames, channel after channel, shape (n, units).

        In each channel y = share · exp(−(d² − d²_min) / contrast) / Σ exp(−(d² − d²_min) / contrast).

        Args:
            postures: (n, 15, 3), upright, scaled, metres.
            velocities: (n, 15, 3), of the same joints, as `Kinematics` defines them.
        """
        rows = frame_inputs(postures, velocities)
        sides = rows, mirrored_inputs(rows)
        blocks = [_excess2s(self.maps[name], MAP_INPUTS[name].of(sides[mirrored])) for name, mirrored in CHANNELS]
        return self._normalised(np.concatenate(blocks, axis=1))

    def running_sums(self, postures: Floats, velocities: Floats) -> Sums:
        """Return the sums of the quantised activities before each of many frames, and after the last, (n + 1, units).

        Args:
            postures: (n, 15, 3), as for `activities`.
            velocities: (n, 15, 3).
        """
        missing = np.isnan(postures).any() or np.isnan(velocities).any()
        if steps is None or self.postures.dtype != np.float32 or missing:
            return running_sums(self.activities(postures, velocities))
        sums = np.empty((len(postures) + 1, self.units), np.uint32)
        sums[0] = 0
        frames = (np.ascontiguousarray(each, np.float64) for each in (postures, velocities))
        shares = self.shares.tobytes()
        steps.added_frames(*frames, *MIRRORED, *self._compiled, shares, SCALE, sums)
        return sums

    def winners(self, postures: Floats) -> NDArray[np.intp]:
        """Return the map of postures' winner for each of (n, 15, 3), shape (n,); 0 where all joints are missing."""
        rows, winners = postures.reshape(-1, _SIZE), np.zeros(len(postures), np.intp)
        known = ~np.isnan(rows).all(axis=1)
        winners[known] = self.postures.bmus(rows[known])
        return winners

    def log_errors(self, postures: Floats, winners: Sequence[int] | NDArray[np.intp]) -> Floats:
        """Return log(d²), d² the squared quantization error on the posture map in m², shape (n,).

        It is scaled up for missing joints; where all are missing it is log(`SMALLEST_ERROR2`).

        Args:
            postures: (n, 15, 3).
            winners: (n,), the posture map's winner for each.
        """
        error = postures.reshape(-1, _SIZE) - self.postures.weights[winners]
        mean2 = np.square(error).sum(axis=1) / _SIZE
        if has_unknown(mean2):
            known = ~np.isnan(error)
            mean2 = np.square(np.where(known, error, 0.0)).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
        errors: Floats = np.log(np.maximum(mean2 * _SIZE, SMALLEST_ERROR2))
        return errors

    def frame_activities(self, posture: Floats, velocity: Floats) -> Floats:
        """Return the activities of one frame, as seen and of its mirror image, shape (2, units).

        One matrix product of always the same shape, so that the result never depends on other frames.

        Args:
            posture: (15, 3), NaN where a joint is missing.
            velocity: (15, 3).
        """
        row = np.concatenate([posture, velocity]).ravel()
        rows = np.array([row, mirrored_inputs(row)])
        if has_unknown(row):
            excess2s = self._partly_known(rows)
        else:
            excess2s = self._together.excess2s(np.concatenate([each.of(rows) for each in MAP_INPUTS.values()], axis=1))
        of_map = dict(zip(MAP_INPUTS, excess2s.swapaxes(0, 1), strict=True))
        blocks = [of_map[name][::-1] if mirrored else of_map[name] for name, mirrored in CHANNELS]
        return self._normalised(np.concatenate(blocks, axis=1))

    def unnormalised_activities(self, steps: ModuleType, posture: Floats, velocity: Floats) -> NDArray[np.float32]:
        """Return one frame's activities, (2, units), before they are divided by their sums, by compiled steps.

        Args:
            steps: the compiled functions.
            posture: (15, 3), contiguous, no joint missing.
            velocity: (15, 3), contiguous.
        """
        activities = np.empty((2, self.units), np.float32)
        steps.exponents(posture, velocity, *MIRRORED, *self._compiled, activities)
        return np.exp(activities, out=activities)

    def _partly_known(self, rows: Floats) -> Floats:
        """Return d² − d²_min of each map for rows (2, 90) with missing components, shape (2, maps, units)."""
        inputs = [(self.maps[name], each.of(rows)) for name, each in MAP_INPUTS.items()]
        return np.array([[_excess2(som, map_rows[side]) for som, map_rows in inputs] for side in (0, 1)])

    def _normalised(self, excess2s: Floats) -> Floats:
        """Return the activities for d² − d²_min (n, units), same shape; overwrites its argument."""
        activities = excess2s.reshape(len(excess2s), len(CHANNELS), -1)
        activities *= self._slopes
        np.exp(activities, out=activities)
        activities *= self.shares / activities.sum(axis=2, keepdims=True)
        return activities.reshape(excess2s.shape)

    @cached_property
    def _together(self) -> Together:
        return Together([self.maps[name] for name in MAP_INPUTS])

    @cached_property
    def _slopes(self) -> NDArray[np.float32]:
        return (-1 / np.array([self.contrasts[name] for name, _ in CHANNELS]))[:, None].astype(np.float32)

    @cached_property
    def _compiled(self) -> tuple[bytes, ...]:
        """What the compiled steps read of the maps, as bytes.

        Of each map its inputs, their number, the centre, the slopes in blocks of units, and the terms that are added to
        products; of each channel its map, its side and the slope of its activity.
        """
        lookups = [self.maps[name].lookup for name in MAP_INPUTS]
        columns, less, factors = map(np.concatenate, zip(*[each.compiled for each in MAP_INPUTS.values()], strict=True))
        dims = np.array([lookup.dim for lookup in lookups])
        of_channel = np.array([(list(MAP_INPUTS).index(name), mirrored) for name, mirrored in CHANNELS])
        centres, half_norms2 = (
            b"".join(getattr(lookup, name).tobytes() for lookup in lookups) for name in ("centre", "half_norms2")
        )
        slopes = b"".join(_in_blocks(lookup.slopes).tobytes() for lookup in lookups)
        columns, less, dims, maps, sides = (
            each.astype(np.int32).tobytes() for each in (columns, less, dims, *of_channel.T)
        )
        return columns, less, factors.tobytes(), dims, centres, slopes, half_norms2, maps, sides, self._slopes.tobytes()

    @cached_property
    def posture_weights(self) -> bytes:
        """The weights of the map of postures, (units, 45) single-precision numbers, one after the other."""
        return self.postures.weights.astype(np.float32).tobytes()

    @cached_property
    def shares(self) -> NDArray[np.float32]:
        """The sum of each channel's activity, (channels, 1)."""
        shares = dict(zip((ACTING_ARM, OTHER_ARM), self.arm_shares, strict=True))
        return np.array([shares.get(channel, 1.0) for channel in CHANNELS], np.float32)[:, None]


def _in_blocks(slopes: Floats) -> Floats:
    """Return (dim, units) in blocks of `BLOCK` units, (blocks, dim, BLOCK), with zeros for units beyond the last."""
    padded = np.pad(slopes, ((0, 0), (0, -slopes.shape[1] % BLOCK)))
    return np.ascontiguousarray(padded.reshape(len(slopes), -1, BLOCK).swapaxes(0, 1))


def _excess2(som: Som, x: Floats) -> Floats:
    """Return d² − d²_min of each unit for x (dim,), shape (units,); all 0 where every component is missing."""
    return np.zeros(len(som.weights), som.dtype) if np.isnan(x).all() else som.excess2(x)


def _excess2s(som: Som, rows: Floats) -> Floats:
    """Return d² − d²_min of each unit for rows (n, dim), shape (n, units); 0 where all of a row is missing."""
    known = ~np.isnan(rows).all(axis=1)
    excess2s = np.zeros((len(rows), len(som.weights)), som.dtype)
    excess2s[known] = som.excess2s(rows[known])
    return excess2s
