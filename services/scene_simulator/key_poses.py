"""Free movements of the whole body as key poses, and the frames between them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from actum.arrays import Array
from scene_simulator.inverse_kinematics import Stance
from scene_simulator.timeline import Episode
from scene_simulator.trajectories import bump, elapsed_share, interpolated, minimum_jerk

ARC_SHARE = 0.10
"""Height of a hand's arc as a share of its way: people lift their hands a little on the way."""
FORWARD_SHARE = 0.35
"""Way of a hand before the body as a share of the height it rises or falls by: it goes around the shoulder."""
BEAT_RAMP_S = 0.3
"""Seconds in which a repeated movement sets in and fades."""
STEP_M = 0.60
"""Length of a step of an adult who walks slowly."""
WALKING_M_S = (0.10, 1.30)
"""Speeds of the pelvis at which legs and arms begin to swing, and at which they swing fully; below, feet just shift."""
LEG_SWING_RAD = np.deg2rad(20.0)
"""Largest swing of a thigh: two legs of 0.85 m that swing so are a step of `STEP_M` apart."""
KNEE_BEND_RAD = np.deg2rad(30.0)
"""Largest bend of the knee in slow walking."""
ARM_SWING_M = 0.10
"""Largest swing of a hand forward and back in slow walking."""


@dataclass(frozen=True)
class KeyPose:
    """A pose of the body, relative to where the person stands, and the way to it from the pose before.

    Attributes:
        seconds: duration of the way to this pose.
        hands_m: (2, 3), palms of left and right hand; leftward, up and forward from the pelvis, by the hips' heading.
        shift_m: (2,), leftward and forward displacement of the pelvis.
        turn_rad: turn of the hips to the left.
        twist_rad: turn of the shoulders against the hips to the left.
        lean_rad: forward lean of the trunk, besides the person's own.
        reaching: how far the trunk follows the acting hand, 0 to 1.
        beat_m: (2, 3), amplitude of a repeated movement of the hands on the way, in the directions of `hands_m`.
        beat_hz: its frequency.
        doing: the name of the doing that the way belongs to; None at rest.
    """

    seconds: float
    hands_m: Array
    shift_m: Array = field(default_factory=lambda: np.zeros(2))
    turn_rad: float = 0.0
    twist_rad: float = 0.0
    lean_rad: float = 0.0
    reaching: float = 1.0
    beat_m: Array = field(default_factory=lambda: np.zeros((2, 3)))
    beat_hz: float = 0.0
    doing: str | None = None

    def values(self) -> Array:
        """Return all that is interpolated: hands (6), shift (2), turn, twist, lean, reaching."""
        body = (self.turn_rad, self.twist_rad, self.lean_rad, self.reaching)
        return np.concatenate([self.hands_m.ravel(), self.shift_m, body])


def moving(poses: Sequence[KeyPose], resting: Episode, rate_hz: int) -> Episode:
    """Return the frames from the first pose to the last; `resting` (1 frame) is the scene in which the person moves."""
    values, doings = _between(poses, rate_hz)
    hands, shift = values[:, :6].reshape(-1, 2, 3), values[:, 6:8]
    turn, twist, lean, reaching = values[:, 8:].T
    legs, arms_m = _gait(shift, rate_hz)
    hands[:, :, 2] += arms_m
    stance = _displaced(resting, shift, turn, lean)
    rows = np.zeros(len(values), dtype=int)
    return replace(
        resting,
        pelvis_m=stance.pelvis_m,
        heading_rad=stance.heading_rad,
        hands_m=stance.pelvis_m[:, None] + np.einsum("thk,ktd->thd", hands, np.stack(stance.axes())),
        positions_m=resting.positions_m[rows],
        yaw_rad=resting.yaw_rad[rows],
        riser_tops_m=resting.riser_tops_m[rows],
        grip=resting.grip[rows],
        pointing=resting.pointing[rows],
        lean_rad=lean,
        twist_rad=twist,
        reaching=reaching,
        legs_rad=legs,
        doings=doings,
    )


def _displaced(resting: Episode, shift_m: Array, turn_rad: Array, lean_rad: Array) -> Stance:
    """Return the stance after a shift (T, 2; leftward, forward) and a turn to the left (T,) from that at rest."""
    left, _, forward = Stance(resting.pelvis_m, resting.heading_rad, resting.lean_rad).axes()
    pelvis = resting.pelvis_m + shift_m[:, :1] * left + shift_m[:, 1:] * forward
    return Stance(pelvis, resting.heading_rad - turn_rad, lean_rad)


def _between(poses: Sequence[KeyPose], rate_hz: int) -> tuple[Array, tuple[str | None, ...]]:
    """Return the interpolated values (T, 12) after the first pose, and the doing of each frame (T)."""
    parts, doings = [], []
    for i in range(1, len(poses)):
        start, end = poses[i - 1], poses[i]
        count = max(round(end.seconds * rate_hz), 1)
        time = np.arange(1, count + 1) / rate_hz
        share = time * rate_hz / count
        values = interpolated(start.values(), np.broadcast_to(end.values(), (count, 12)), share)
        ways_m = end.hands_m - start.hands_m
        values[:, [1, 4]] += ARC_SHARE * np.linalg.norm(ways_m, axis=1) * bump(share)[:, None]
        values[:, [2, 5]] += FORWARD_SHARE * np.abs(ways_m[:, 1]) * bump(share)[:, None]
        ramp = min(BEAT_RAMP_S, time[-1] / 2)
        rising = minimum_jerk(elapsed_share(time, 0.0, ramp))
        falling = minimum_jerk(elapsed_share(time, time[-1] - ramp, ramp))
        wave = np.sin(2 * np.pi * end.beat_hz * time) * (rising - falling)
        values[:, :6] += (wave[:, None, None] * end.beat_m).reshape(count, 6)
        parts.append(values)
        doings += [end.doing] * count
    return np.concatenate(parts), tuple(doings)


def _gait(shift_m: Array, rate_hz: int) -> tuple[Array, Array]:
    """Return the legs' angles (T, 2, 2; rad) and the hands' swing forward (T, 2; m) for the pelvis's way (T, 2; m)."""
    steps = np.linalg.norm(np.diff(shift_m, axis=0, prepend=shift_m[:1]), axis=1)
    slow, fast = WALKING_M_S
    strength = minimum_jerk(elapsed_share(steps * rate_hz, slow, fast - slow))[:, None]
    phase = np.pi * np.cumsum(steps)[:, None] / STEP_M + np.array([0.0, np.pi])
    swing = LEG_SWING_RAD * strength * np.sin(phase)
    bend = KNEE_BEND_RAD * strength * (1 + np.cos(phase)) / 2
    return np.stack([swing, bend], axis=-1), -ARM_SWING_M * strength * np.sin(phase)
