"""Posture and velocity of one agent, jitter taken off, frame by frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS

Array = NDArray[np.float64]

GAP_NS = SECOND_NS // 2
STILL_TIME_CONSTANT_S = 0.3
STILL_SPEED_MPS = 0.3
SPEED_TIME_CONSTANT_S = 0.1
LAG_TIME_CONSTANT_S = 0.125


@dataclass(frozen=True, eq=False)
class Kinematics:
    """Where each joint is and where it is going; NaN where a joint is missing.

    Attributes:
        posture: (15, 3), low-passed the more the slower the joint moves.
        velocity: (15, 3), how far each joint is ahead of its own low-pass: m/s times 0.125 s at steady speed.
    """

    posture: Array
    velocity: Array


class KinematicsFilter:
    """A low-pass per joint whose time constant falls with its speed (after Casiez, 2012), then a second for velocity.

    Resting joints are steadied, fast ones hardly delayed. A joint that was away begins anew, and so does everything
    after a gap or where the stamps go back.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self._known = np.ones(0, dtype=bool)
        self._before = self._speed = self._smooth = self._lagging = np.zeros((0, 3))

    def step(self, stamp_ns: int, joints: Array) -> Kinematics:
        """Take the next frame's joints (15, 3), upright, NaN where missing."""
        last_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        known = ~np.isnan(joints[:, 0])
        if last_ns is None or not 0 < stamp_ns - last_ns <= GAP_NS:
            self._begin(joints, known)
            return Kinematics(joints, joints - joints)
        if known.all() and self._known.all():
            self._advance(joints, (stamp_ns - last_ns) / SECOND_NS)
            return Kinematics(self._smooth, self._smooth - self._lagging)
        return self._advance_known(joints, known, (stamp_ns - last_ns) / SECOND_NS)

    def _begin(self, joints: Array, known: NDArray[np.bool_]) -> None:
        self._known = known
        self._before = self._smooth = self._lagging = np.nan_to_num(joints)
        self._speed = np.zeros(joints.shape)

    def _advance(self, joints: Array, elapsed_s: float) -> None:
        moved = (joints - self._before) / elapsed_s
        self._speed = self._speed + (1 - np.exp(-elapsed_s / SPEED_TIME_CONSTANT_S)) * (moved - self._speed)
        speeds = np.sqrt(np.einsum("ij,ij->i", self._speed, self._speed))
        shares = 1 - np.exp(elapsed_s / -STILL_TIME_CONSTANT_S * (1 + speeds / STILL_SPEED_MPS))
        self._before = joints
        step = shares[:, None] * (joints - self._smooth)
        self._lagging = _lagged(self._lagging, self._smooth, step, elapsed_s)
        self._smooth = self._smooth + step

    def _advance_known(self, joints: Array, known: NDArray[np.bool_], elapsed_s: float) -> Kinematics:
        """Advance while joints are missing: their state waits, and those that come back begin where they are."""
        come = (known & ~self._known)[:, None]
        present = np.where(known[:, None], joints, self._before)
        self._before = np.where(come, present, self._before)
        self._smooth = np.where(come, present, self._smooth)
        self._lagging = np.where(come, present, self._lagging)
        self._speed = np.where(known[:, None] & ~come, self._speed, 0.0)
        self._known = known
        self._advance(present, elapsed_s)
        missing = np.where(known, 0.0, np.nan)[:, None]
        return Kinematics(self._smooth + missing, self._smooth - self._lagging + missing)


def _lagged(lagging: Array, start: Array, step: Array, elapsed_s: float) -> Array:
    """Advance a low-pass whose input goes straight from `start` by `step`: exact, whatever the frame rate."""
    behind = LAG_TIME_CONSTANT_S / elapsed_s * step
    lagged: Array = start + step - behind + (lagging - start + behind) * np.exp(-elapsed_s / LAG_TIME_CONSTANT_S)
    return lagged
