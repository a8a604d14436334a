"""The actor's smoothed heading, which defines the upright frame."""

import math

import numpy as np

from actum.arrays import Array
from actum.geometry import SMALLEST_M
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from pose_preprocessor.part_motion import GAP_NS

TIME_CONSTANT_S = 1.0
"""Time constant of the filter: it takes out the direction in which the actor stands, but no turn within an action."""
FIRST_S = 1 / 30
"""The duration as which the first frame counts (s): one frame of a 30 Hz camera."""

FACING_SD_RAD = math.radians(15.0)
"""Prior standard deviation of the yaw of people who act for a camera, from facing it."""
VARIANCE_INFLATION = 2.0
"""Factor from the variance of single frames to that of the filtered heading: their errors are correlated in time."""

_SMALLEST = 1e-3
"""A mean of unit vectors that is shorter than this has no direction."""
_LEFT = [INDEX["left_hip"], INDEX["left_shoulder"]]
_RIGHT = [INDEX["right_hip"], INDEX["right_shoulder"]]
PAIRS = np.array([_RIGHT, _LEFT], np.int32).tobytes()
"""Right hip and shoulder, then left ones, as the compiled step reads them."""
TUNED = np.array([FIRST_S, TIME_CONSTANT_S, _SMALLEST, VARIANCE_INFLATION, FACING_SD_RAD**2, math.tau]).tobytes()
"""The constants of the filter, as the compiled step reads them."""


class HeadingFilter:
    """One agent's direction to the left in the horizontal plane: a mean at first, then a first-order filter.

    m += a (h - m), with a = max(1 - exp(-dt / 1 s), dt / T) and T the time since the filter began.

    The yaw ψ from facing the camera is then shrunk towards 0 by its measured variance v, which is large where the
    hips are tracked poorly: ψ (1 - cos ψ · 2v / (2v + (15°)²)). Beyond a quarter turn it stays as it is.

    Attributes:
        state: (6,), T (s), the mean (x, z), v (rad²) and the last answer (x, z); the compiled step advances it, too.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self.state = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])

    def elapsed_s(self, stamp_ns: int) -> float:
        """Return how long after the frame before a frame is (s), 0 for the first and after a gap: stamps rise."""
        before_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        return 0.0 if before_ns is None or stamp_ns - before_ns > GAP_NS else (stamp_ns - before_ns) / SECOND_NS

    def step(self, stamp_ns: int, joints: Array) -> tuple[float, float]:
        """Return the unit vector (camera x, z) to the actor's left; after a gap the filter restarts.

        Where no direction is defined, as for a person lying on one side, it is the last one, at first that of a person
        who faces the camera.

        Args:
            stamp_ns: rising from call to call.
            joints: (15, 3), frame of a level camera, metres; NaN where unknown.
        """
        elapsed_s, left = self.elapsed_s(stamp_ns), _horizontal_left(joints)
        span_s, x, z, variance_rad2, left_x, left_z = self.state.tolist()
        if elapsed_s == 0.0:
            span_s, (x, z), variance_rad2 = FIRST_S, left, 0.0
        else:
            span_s += elapsed_s
            smoothing_gain = 1.0 - math.exp(-elapsed_s / TIME_CONSTANT_S)
            weight = max(smoothing_gain, elapsed_s / span_s)
            x, z = x + weight * (left[0] - x), z + weight * (left[1] - z)
            if math.hypot(*left) >= _SMALLEST:
                error_rad = math.remainder(_yaw_rad(left) - _yaw_rad((x, z)), math.tau)
                variance_rad2 += smoothing_gain * (error_rad * error_rad - variance_rad2)
        if math.hypot(x, z) >= _SMALLEST:
            seen_rad, variance = _yaw_rad((x, z)), VARIANCE_INFLATION * variance_rad2
            yaw_rad = seen_rad * (1.0 - max(math.cos(seen_rad), 0.0) * variance / (variance + FACING_SD_RAD**2))
            left_x, left_z = math.cos(yaw_rad), math.sin(yaw_rad)
        self.state[:] = span_s, x, z, variance_rad2, left_x, left_z
        return left_x, left_z


def _yaw_rad(left: tuple[float, float]) -> float:
    """Return the yaw from facing the camera of an actor whose left is (camera x, z)."""
    return math.atan2(left[1], left[0])


def _horizontal_left(joints: Array) -> tuple[float, float]:
    """Return the mean (camera x, z) of the unit vectors from right to left hip and shoulder, where both are known."""
    units = []
    for right, left in zip(joints[_RIGHT].tolist(), joints[_LEFT].tolist(), strict=True):
        x, y, z = left[0] - right[0], left[1] - right[1], left[2] - right[2]
        length = math.sqrt(x * x + y * y + z * z)
        if length >= SMALLEST_M:
            units.append((x / length, z / length))
    count = max(len(units), 1)
    return sum(x for x, _ in units) / count, sum(z for _, z in units) / count
