"""Episodes of the scene as arrays over T frames: standing still, acting, returning to rest."""

from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array
from scene_simulator.parameters import Parameters
from scene_simulator.trajectories import (
    bent_path,
    bump,
    elapsed_share,
    interpolated,
    minimum_jerk,
    set_down_displacement,
    straight_displacement,
)
from scene_simulator.trial import Layout, Trial

CLOSING_S = 0.2
"""Seconds in which the hand closes or opens."""
OPENING_SHARE = 0.3
"""First share of the return to rest, in which the hand releases a held object."""


@dataclass(frozen=True)
class Episode:
    """T frames of one repetition, or without one (`segment` is None): of a pause, or of everyday doings.

    `trial` is the repetition of which this is a part or the end, `doings` (T) names the everyday doing of each frame.
    Shapes: `pelvis_m` (T, 3), `heading_rad` (T,), `hands_m` (T, 2, 3), objects' `positions_m` (T, n, 3) and
    `yaw_rad` (T, n), `riser_tops_m` (T, n, 3), `grip` and `pointing` (T,). The trunk's `lean_rad` (T,) is added to the
    person's own; it, `twist_rad` (T,), `reaching` (T,) and `legs_rad` (T, 2, 2) are as in `actor.Stance`.
    """

    trial: Trial | None
    segment: int | None
    pelvis_m: Array
    heading_rad: Array
    hands_m: Array
    positions_m: Array
    yaw_rad: Array
    riser_tops_m: Array
    grip: Array
    pointing: Array
    lean_rad: Array
    twist_rad: Array
    reaching: Array
    legs_rad: Array
    doings: tuple[str | None, ...]

    def __len__(self) -> int:
        return len(self.grip)


def still(parameters: Parameters, layout: Layout, seconds: float) -> Episode:
    """Return an episode of a number of seconds in which everything rests in a layout."""
    count = round(seconds * parameters.camera.frame_rate_hz)
    tops = layout.positions_m.copy()
    tops[:, 1] = parameters.table_y_m - layout.riser_heights_m
    return Episode(
        trial=None,
        segment=None,
        pelvis_m=_repeated(layout.pelvis_m, count),
        heading_rad=np.full(count, layout.heading_rad),
        hands_m=_repeated(layout.rest_m, count),
        positions_m=_repeated(layout.positions_m, count),
        yaw_rad=_repeated(layout.yaw_rad, count),
        riser_tops_m=_repeated(tops, count),
        grip=np.zeros(count),
        pointing=np.zeros(count),
        lean_rad=np.zeros(count),
        twist_rad=np.zeros(count),
        reaching=np.ones(count),
        legs_rad=np.zeros((count, 2, 2)),
        doings=(None,) * count,
    )


def acting(parameters: Parameters, trial: Trial, segment: int, column: int) -> Episode:
    """Return the episode of one repetition: reach, grasp, effect, hold; `column` is 0 if the left hand acts, else 1."""
    rate = parameters.camera.frame_rate_hz
    base = still(parameters, trial.layout, trial.timing.duration_s + 1 / rate)
    time = np.arange(len(base)) / rate
    share = elapsed_share(time, 0.0, trial.timing.reach_s)
    moved = _moved(trial, time)
    hands, positions = base.hands_m.copy(), base.positions_m.copy()
    hands[:, column] = moved + bent_path(trial.layout.rest_m[column], trial.hand_m, trial.bulge_m, share)
    positions[:, trial.target] += moved
    pointing = minimum_jerk(share) * (trial.task.action == "point")
    return replace(
        base,
        trial=trial,
        segment=segment,
        hands_m=hands,
        positions_m=positions,
        grip=_grip(trial, time),
        pointing=pointing,
    )


def resetting(parameters: Parameters, done: Episode, following: Layout, seconds: float, return_s: float) -> Episode:
    """Return the episode of a pause: within `return_s` hands and objects move to the layout of what follows.

    Objects that change place hop there; the others stand still.
    """
    goal = still(parameters, following, seconds)
    time = np.arange(1, len(goal) + 1) / parameters.camera.frame_rate_hz
    share = elapsed_share(time, 0.0, return_s)
    opened = 1 - minimum_jerk(elapsed_share(share, 0.0, OPENING_SHARE))
    hop = bump(share)[:, None, None] * np.array([0.0, -parameters.pause.hop_m, 0.0])
    changes = (following.positions_m != done.positions_m[-1]).any(axis=1)
    return replace(
        goal,
        trial=done.trial,
        pelvis_m=interpolated(done.pelvis_m[-1], goal.pelvis_m, share),
        heading_rad=interpolated(done.heading_rad[-1], goal.heading_rad, share),
        hands_m=interpolated(done.hands_m[-1], goal.hands_m, share) + 2 * hop,
        positions_m=interpolated(done.positions_m[-1], goal.positions_m, share) + hop * changes[:, None],
        yaw_rad=interpolated(done.yaw_rad[-1], goal.yaw_rad, share),
        riser_tops_m=interpolated(done.riser_tops_m[-1], goal.riser_tops_m, share),
        grip=done.grip[-1] * opened,
        pointing=done.pointing[-1] * opened,
    )


def _moved(trial: Trial, time_s: Array) -> Array:
    """Return the displacement (T, 3; m) of the object, and of the hand that moves it, at times (T,)."""
    timing = trial.timing
    if trial.task.action == "point":
        return np.zeros((len(time_s), 3))
    share = elapsed_share(time_s, timing.reach_s + timing.grasp_s, timing.effect_s)
    displacement = set_down_displacement if trial.task.action == "put" else straight_displacement
    return displacement(trial.displacement_m, share)


def _grip(trial: Trial, time_s: Array) -> Array:
    """Return the hand's grip (T,; 0 to 1): closed from its arrival until after the effect, or until a lift's end."""
    timing = trial.timing
    if trial.task.action == "point":
        return np.zeros_like(time_s)
    grasped = timing.reach_s + timing.grasp_s
    closed = minimum_jerk(elapsed_share(time_s, grasped - CLOSING_S, CLOSING_S))
    if trial.task.action == "lift":
        return closed
    return closed * (1 - minimum_jerk(elapsed_share(time_s, grasped + timing.effect_s, CLOSING_S)))


def _repeated(value: Array, count: int) -> Array:
    return np.broadcast_to(value, (count, *value.shape))
