"""Which way an actor is turned, smoothed, and how far that can be believed: what the upright posture goes by."""

import math

import numpy as np
from numpy.typing import NDArray

from actum.geometry import SMALLEST_M
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from pose_preprocessor.part_motion import GAP_NS

TIME_CONSTANT_S = 1.0
FIRST_S = 1 / 30
"""How long the first frame counts for."""

FACING_SD_RAD = math.radians(15.0)
"""How far people who act for a camera are turned from it."""
DOUBT = 2.0
"""How much more than the unsteadiness of single frames their mean is off: what disturbs one disturbs the next."""

_SMALLEST = 1e-3
_LEFT = [INDEX["left_hip"], INDEX["left_shoulder"]]
_RIGHT = [INDEX["right_hip"], INDEX["right_shoulder"]]


class HeadingFilter:
    """One agent's direction to the left in the horizontal plane: a mean at first, then a first-order filter.

    m += a (h - m), with a = max(1 - exp(-dt / 1 s), dt / T) and T the time since the filter began: a turn within
    an action stays in the posture, the direction in which the actor stands does not.

    A heading that sways with variance v, as where the hips are tracked poorly, is believed the less: its yaw ψ from
    facing the camera becomes ψ (1 - cos ψ · 2v / (2v + (15°)²)), and stays itself beyond a quarter turn.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self._span_s = 0.0
        self._mean = (0.0, 0.0)
        self._sway_rad2 = 0.0
        self._left = (1.0, 0.0)

    def step(self, stamp_ns: int, joints: NDArray[np.float64]) -> tuple[float, float]:
        """Return the unit vector (camera x, z) to the actor's left; begins anew after a gap.

        Where no direction is defined, as for one who lies on the side, it is the last one, or facing the camera.

        Args:
            stamp_ns: rising from call to call.
            joints: (15, 3), frame of a level camera, metres; NaN where unknown.
        """
        before_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        left = _horizontal_left(joints)
        if before_ns is None or stamp_ns - before_ns > GAP_NS:
            self._span_s, self._mean, self._sway_rad2 = FIRST_S, left, 0.0
        else:
            self._approach(left, (stamp_ns - before_ns) / SECOND_NS)
        if math.hypot(*self._mean) >= _SMALLEST:
            yaw_rad = self._believed_rad(_yaw_rad(self._mean))
            self._left = (math.cos(yaw_rad), math.sin(yaw_rad))
        return self._left

    def _approach(self, left: tuple[float, float], elapsed_s: float) -> None:
        self._span_s += elapsed_s
        fading = 1.0 - math.exp(-elapsed_s / TIME_CONSTANT_S)
        share = max(fading, elapsed_s / self._span_s)
        (x, z), (left_x, left_z) = self._mean, left
        self._mean = (x + share * (left_x - x), z + share * (left_z - z))
        if math.hypot(*left) >= _SMALLEST:
            off_rad = math.remainder(_yaw_rad(left) - _yaw_rad(self._mean), math.tau)
            self._sway_rad2 += fading * (off_rad * off_rad - self._sway_rad2)

    def _believed_rad(self, yaw_rad: float) -> float:
        """Return a yaw drawn towards facing the camera, as far as it sways."""
        doubted = DOUBT * self._sway_rad2
        return yaw_rad * (1.0 - max(math.cos(yaw_rad), 0.0) * doubted / (doubted + FACING_SD_RAD**2))


def _yaw_rad(left: tuple[float, float]) -> float:
    """Return by how much one whose left is (camera x, z) is turned from facing the camera."""
    return math.atan2(left[1], left[0])


def _horizontal_left(joints: NDArray[np.float64]) -> tuple[float, float]:
    """Average the unit vectors from right to left, of hips and of shoulders, where both ends are known."""
    across = joints[_LEFT] - joints[_RIGHT]
    lengths = np.sqrt(np.einsum("ij,ij->i", across, across))
    known = lengths >= SMALLEST_M
    if known.all():
        left = (across / lengths[:, None]).sum(axis=0) / 2
    else:
        left = (across[known] / lengths[known, None]).sum(axis=0)
    return float(left[0]), float(left[2])
