"""Smoothed positions and velocities of one agent's joints, frame by frame, and how far a person moves in a segment."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Mask, has_unknown
from actum.core import steps
from actum.node import SECOND_NS

GAP_NS = SECOND_NS // 2
"""After a longer pause (ns) the filter restarts: a joint may have gone anywhere in between."""
STILL_TIME_CONSTANT_S = 0.3
"""Time constant of the low-pass for a joint at rest: long enough for tracking noise to average out."""
STILL_SPEED_MPS = 0.3
"""Speed (m/s) at which the time constant is half of that at rest; it falls further with the speed."""
SPEED_TIME_CONSTANT_S = 0.1
"""Time constant of the low-pass for the velocity whose norm is the speed: short, to notice a movement's start soon."""
LAG_TIME_CONSTANT_S = 0.125
"""Time constant of the second low-pass: at a constant velocity it lags behind by velocity times this."""


class Kinematics(NamedTuple):
    """Position and velocity of each joint in the upright frame; NaN where a joint is missing.

    Attributes:
        posture: (15, 3), metres, low-passed, more strongly the slower the joint moves.
        velocity: (15, 3), metres, `posture` less its own low-pass: a constant velocity in m/s, times 0.125 s.
    """

    posture: Array
    velocity: Array


class KinematicsFilter:
    """A low-pass per joint whose time constant falls with its speed (after Casiez, 2012), then a second for velocity.

    Noise of resting joints is suppressed, fast ones are hardly delayed. With s the low-passed speed of a joint,
    x += (1 - exp(-dt (1 + s / 0.3 m/s) / 0.3 s)) (measured - x). A joint's filter restarts after it was missing, those
    of all joints after a gap or where stamps go back.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self._known: Mask | None = None  # None where all are
        self._before = np.zeros((0, 3))
        self._state = np.zeros((3, 0, 3))  # speeds, smooth and lagging positions

    def step(self, stamp_ns: int, joints: Array) -> Kinematics:
        """Receive the next frame's joints and return their kinematics.

        Args:
            stamp_ns: of the frame.
            joints: (15, 3), upright, metres, NaN where missing.
        """
        joints = np.ascontiguousarray(joints, np.float64)
        last_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        if last_ns is None or not 0 < stamp_ns - last_ns <= GAP_NS:
            known = ~np.isnan(joints[:, 0])
            self._known = None if known.all() else known
            self._before = np.nan_to_num(joints)
            self._state = np.stack([np.zeros(joints.shape), self._before, self._before])
            return Kinematics(joints, joints - joints)
        elapsed_s = (stamp_ns - last_ns) / SECOND_NS
        advanced = self._advanced(joints, elapsed_s) if self._known is None else None
        if advanced is None:
            return self._advance_known(joints, ~np.isnan(joints[:, 0]), elapsed_s)
        self._before = joints
        return advanced

    def _advanced(self, joints: Array, elapsed_s: float) -> Kinematics | None:
        """Advance the state, and return the next frame's kinematics; None and no change where a joint is missing."""
        if steps is None:
            return None if has_unknown(joints[:, 0]) else self._advanced_in_numpy(joints, elapsed_s)
        kinematics = np.empty((2, *joints.shape))
        gain, decay = 1 - math.exp(-elapsed_s / SPEED_TIME_CONSTANT_S), math.exp(-elapsed_s / LAG_TIME_CONSTANT_S)
        known = steps.smoothed(
            joints, self._before, self._state, elapsed_s, gain, STILL_TIME_CONSTANT_S, STILL_SPEED_MPS,
            LAG_TIME_CONSTANT_S, decay, kinematics,
        )  # fmt: skip
        return Kinematics(*kinematics) if known else None

    def _advanced_in_numpy(self, joints: Array, elapsed_s: float) -> Kinematics:
        speed, smooth, lagging = self._state
        velocity = (joints - self._before) / elapsed_s
        velocity -= speed
        velocity *= 1 - math.exp(-elapsed_s / SPEED_TIME_CONSTANT_S)
        speed += velocity
        speeds = np.sqrt(np.einsum("ij,ij->i", speed, speed))
        gains = 1 - np.exp(elapsed_s / -STILL_TIME_CONSTANT_S * (1 + speeds / STILL_SPEED_MPS))
        step = joints - smooth
        step *= gains[:, None]
        lagging[:] = _lagged(lagging, smooth, step, elapsed_s)
        smooth += step
        return Kinematics(smooth.copy(), smooth - lagging)

    def _advance_known(self, joints: Array, known: Mask, elapsed_s: float) -> Kinematics:
        """Advance while joints are missing: their state is kept, and the filters of those that come back restart."""
        returned = (np.zeros_like(known) if self._known is None else known & ~self._known)[:, None]
        present = np.where(known[:, None], joints, self._before)
        speed, smooth, lagging = self._state
        self._before = np.where(returned, present, self._before)
        smooth, lagging = np.where(returned, present, smooth), np.where(returned, present, lagging)
        self._state = np.stack([np.where(known[:, None] & ~returned, speed, 0.0), smooth, lagging])
        self._known = None if known.all() else known
        advanced = self._advanced(present, elapsed_s)
        assert advanced is not None
        self._before = present
        missing = np.where(known, 0.0, np.nan)[:, None]
        return Kinematics(advanced.posture + missing, advanced.velocity + missing)


def _lagged(lagging: Array, start: Array, step: Array, elapsed_s: float) -> Array:
    """Advance a low-pass (15, 3) whose input moves linearly from `start` by `step`: exact at any frame rate."""
    behind = LAG_TIME_CONSTANT_S / elapsed_s * step
    lagged: Array = start + step - behind + (lagging - start + behind) * math.exp(-elapsed_s / LAG_TIME_CONSTANT_S)
    return lagged


REMOVED_SHARE = 0.75
"""The share of speed times time constant by which joints lead on average: noise of resting joints counts as speed."""


def as_measured(posture: Array, velocity: Array) -> Array:
    """Return about the joints (…, 15, 3) before the low-pass, which a moving joint leads by speed times time constant.

    Args:
        posture: (…, 15, 3), of `Kinematics`.
        velocity: (…, 15, 3), of `Kinematics`.
    """
    velocity_mps = velocity / LAG_TIME_CONSTANT_S
    speed_mps = np.sqrt(np.square(velocity_mps).sum(axis=-1, keepdims=True))
    delay_s = STILL_TIME_CONSTANT_S / (1 + speed_mps / STILL_SPEED_MPS)
    measured: Array = posture + REMOVED_SHARE * delay_s * velocity_mps
    return measured


AVERAGED_NS = SECOND_NS // 4
"""Postures are averaged over this long (ns): longer than a jump of a joint, shorter than any action."""


def movement_m(means: Array) -> float:
    """Return the distance between the two most different postures of a segment (m).

    The distance between two is the root mean square over the two joints that are farthest apart: a hand moves with its
    elbow, while jitter moves each joint by itself. Unlike the length of a path, it grows with neither the number of
    frames nor their jitter.

    Args:
        means: (intervals, 15, 3), as `averaged` returns them.
    """
    joints = means.swapaxes(0, 1)
    apart = np.square(joints[:, :, None] - joints[:, None])
    apart_m2 = apart[..., 0] + apart[..., 1] + apart[..., 2]
    if np.isnan(means).any():
        apart_m2 = np.nan_to_num(apart_m2)
    two_m2 = np.partition(apart_m2, -2, axis=0)[-2:]
    return float(np.sqrt((two_m2[1] + two_m2[0]).max() / 2))


def averaged(stamps_ns: NDArray[np.int64], postures: Array) -> Array:
    """Return the mean posture of each quarter of a second, (intervals, 15, 3), NaN where a joint is missing throughout.

    Args:
        stamps_ns: (n,), rising.
        postures: (n, 15, 3), low-passed, metres, NaN where a joint is missing.
    """
    interval = (stamps_ns - stamps_ns[0]) // AVERAGED_NS
    first = np.flatnonzero(np.diff(interval, prepend=-1))
    missing = np.isnan(postures)
    if not missing.any():
        complete: Array = np.add.reduceat(postures, first, axis=0)
        complete /= np.diff(first, append=len(postures))[:, None, None]
        return complete
    known = np.add.reduceat(~missing, first, axis=0, dtype=np.float64)
    sums: Array = np.add.reduceat(np.nan_to_num(postures), first, axis=0)
    means: Array = np.divide(sums, known, out=np.full_like(sums, np.nan), where=known > 0)
    return means
