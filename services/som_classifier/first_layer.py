"""The two layers of maps of the default recogniser, each answering with a soft activity."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import INDEX, JOINTS
from actum.som import Som, Together
from som_classifier.handedness import ACROSS, OPPOSITE

Floats = NDArray[Any]

VELOCITY_WEIGHT = 3.0
"""What a joint's velocity counts beside its position in the map of arms: both then spread about alike."""
ARM_INPUTS = 12
CHANNELS = ("postures", "velocities", "acting arm", "other arm")
"""Whose activity a frame gives, in this order; the map of arms is asked for both arms."""
SMALLEST_ERROR2 = 6e-5
"""Squared quantization errors (m²) below this, 2 mm a joint on the mean, count as this: a logarithm knows no bottom."""

_SIZE = 3 * len(JOINTS)
_ARM = np.arange(3 * INDEX["right_elbow"], 3 * INDEX["right_hand"] + 3)
_SHOULDER = np.tile(np.arange(3), 2) + 3 * INDEX["right_shoulder"]
_ENDS, _ROOTS = (np.concatenate([components, components + _SIZE]) for components in (_ARM, _SHOULDER))
_COUNTS = np.repeat([1.0, VELOCITY_WEIGHT], len(_ARM))
_MIRROR = np.concatenate([(3 * OPPOSITE[:, None] + np.arange(3)).ravel() + start for start in (0, _SIZE)])
_SIGNS = np.tile(ACROSS, 2 * len(JOINTS))


def frame_inputs(postures: Floats, velocities: Floats) -> Floats:
    """Return postures and velocities (n, 15, 3) as rows of all their components, shape (n, 90)."""
    return np.concatenate([postures.reshape(-1, _SIZE), velocities.reshape(-1, _SIZE)], axis=1)


def mirrored_inputs(rows: Floats) -> Floats:
    """Return such rows (…, 90) as the actor's mirror image has them."""
    mirrored_rows: Floats = rows[..., _MIRROR] * _SIGNS
    return mirrored_rows


def arm_inputs(rows: Floats) -> Floats:
    """Return the right elbow and hand as seen from the shoulder, where and how fast, shape (n, 12), of (n, 90).

    In a mirror it is the left arm.
    """
    inputs: Floats = (rows[:, _ENDS] - rows[:, _ROOTS]) * _COUNTS
    return inputs


@dataclass(frozen=True, eq=False)
class FirstMaps:
    """The first layer: a map of postures, one of velocities, one of arms, each with a soft activity.

    Attributes:
        contrasts: of each map's activity, in its squared distance.
        arm_shares: what the activity of the map of arms adds up to, for the acting arm and for the other one; that of
            the others adds up to 1.
    """

    postures: Som
    velocities: Som
    arms: Som
    contrasts: tuple[float, float, float]
    arm_shares: tuple[float, float]

    @property
    def maps(self) -> tuple[Som, Som, Som]:
        """All three."""
        return self.postures, self.velocities, self.arms

    @property
    def units(self) -> int:
        """How many activities there are in all, as many of each map, those of the map of arms twice."""
        return len(CHANNELS) * len(self.postures.weights)

    def activities(self, postures: Floats, velocities: Floats) -> Floats:
        """Return y = share × exp(−(d² − d²_min) / contrast) / Σ of each map for (n, 15, 3) inputs, shape (n, units)."""
        rows = frame_inputs(postures, velocities)
        heard = [*zip(self.maps, _of_maps(rows), strict=True), (self.arms, arm_inputs(mirrored_inputs(rows)))]
        return self._shared(np.concatenate([_excess2s(som, inputs) for som, inputs in heard], axis=1))

    def winners(self, postures: Floats) -> NDArray[np.intp]:
        """Return the map of postures' winner for each of (n, 15, 3), shape (n,); the first where nothing is known."""
        winners: NDArray[np.intp] = _excess2s(self.postures, postures.reshape(-1, _SIZE)).argmin(axis=1)
        return winners

    def log_errors(self, postures: Floats, winners: Sequence[int] | NDArray[np.intp]) -> Floats:
        """Return log(d²) to the winners on the map of postures, the squared quantization error in m², shape (n,).

        Scaled up for the joints that are missing; that of no error at all where all are.

        Args:
            postures: (n, 15, 3).
            winners: (n,), the unit nearest to each.
        """
        off = postures.reshape(-1, _SIZE) - self.postures.weights[winners]
        known = ~np.isnan(off)
        mean2 = np.square(np.where(known, off, 0.0)).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
        errors: Floats = np.log(np.maximum(mean2 * _SIZE, SMALLEST_ERROR2))
        return errors

    def frame_activities(self, posture: Floats, velocity: Floats) -> Floats:
        """Return the same for one frame (15, 3) as seen and in a mirror, shape (2, units).

        By a product of always the same shape, so that it never depends on other frames.
        """
        row = np.concatenate([posture, velocity]).ravel()
        rows = np.array([row, mirrored_inputs(row)])
        if math.isnan(row.sum()):
            excess2s = self._partly_known(rows)
        else:
            excess2s = self._together.excess2s(np.concatenate([rows, arm_inputs(rows)], axis=1))
        other_arm = excess2s[::-1, -1:]
        return self._shared(np.concatenate([excess2s, other_arm], axis=1).reshape(2, -1))

    def _partly_known(self, rows: Floats) -> Floats:
        inputs = _of_maps(rows)
        excess2s = [_excess2(som, own[side]) for side in (0, 1) for som, own in zip(self.maps, inputs, strict=True)]
        return np.concatenate(excess2s).reshape(2, len(self.maps), -1)

    def _shared(self, excess2s: Floats) -> Floats:
        """Make activities of d² − d²_min (n, units)."""
        activities = excess2s.reshape(len(excess2s), len(CHANNELS), -1)
        activities *= self._slopes
        np.exp(activities, out=activities)
        activities *= self._shares / activities.sum(axis=2, keepdims=True)
        return activities.reshape(excess2s.shape)

    @cached_property
    def _together(self) -> Together:
        return Together(self.maps)

    @cached_property
    def _slopes(self) -> NDArray[np.float32]:
        return (-1 / np.array([*self.contrasts, self.contrasts[-1]]))[:, None].astype(np.float32)

    @cached_property
    def _shares(self) -> NDArray[np.float32]:
        return np.array([1.0, 1.0, *self.arm_shares], np.float32)[:, None]


def _of_maps(rows: Floats) -> tuple[Floats, Floats, Floats]:
    return rows[:, :_SIZE], rows[:, _SIZE:], arm_inputs(rows)


def _excess2(som: Som, x: Floats) -> Floats:
    """Return d² − d²_min of each unit; where nothing is known of x they are all as near."""
    return np.zeros(len(som.weights), som.dtype) if np.isnan(x).all() else som.excess2(x)


def _excess2s(som: Som, rows: Floats) -> Floats:
    known = ~np.isnan(rows).all(axis=1)
    excess2s = np.zeros((len(rows), len(som.weights)), som.dtype)
    excess2s[known] = som.excess2s(rows[known])
    return excess2s
