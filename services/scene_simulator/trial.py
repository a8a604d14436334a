"""Random trials: the layout, the durations of the phases and the hand's path in one repetition of an action."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import HIP_HEIGHT, Actor
from scene_simulator.inverse_kinematics import Stance
from scene_simulator.parameters import ObjectItem, Parameters, TrialParameters
from scene_simulator.pointing import pointing_palm
from scene_simulator.programme import Task
from scene_simulator.random_streams import draw_normal, draw_normals, draw_uniform

RISER_PROBABILITY = {"put": 1.0, "push": 0.0, "pull": 0.0}
"""Probability that the target stands on a riser, for actions that determine it."""


@dataclass(frozen=True)
class Timing:
    """Durations of the phases in seconds; the rest of the whole duration is a hold."""

    duration_s: float
    reach_s: float
    grasp_s: float
    effect_s: float


@dataclass(frozen=True)
class Layout:
    """Positions of the three objects, in their order, and of the person at the start, in the camera frame.

    Attributes:
        positions_m: (3, 3), the centres of the markers.
        yaw_rad: (3,), rotations of the objects about the vertical.
        riser_heights_m: (3,), heights of the risers under the objects, 0 for none.
        pelvis_m: (3,), the person's pelvis.
        heading_rad: the person's heading; 0 faces the camera.
        rest_m: (2, 3), the resting palms, left and right.
    """

    positions_m: Array
    yaw_rad: Array
    riser_heights_m: Array
    pelvis_m: Array
    heading_rad: float
    rest_m: Array


@dataclass(frozen=True)
class Trial:
    """The random parameters of one repetition.

    Attributes:
        target: the object's index.
        hand_m: (3,), the palm's position at the end of the reach.
        bulge_m: (3,), deviation of the reach from a straight line.
        displacement_m: (3,), displacement of the object by the effect.
        finger_overlap_m: length of the fingers over the marked face.
        pause_s: duration of the pause after the repetition.
    """

    task: Task
    timing: Timing
    layout: Layout
    target: int
    hand_m: Array
    bulge_m: Array
    displacement_m: Array
    finger_overlap_m: float
    pause_s: float


def draw_trial(parameters: Parameters, actor: Actor, task: Task, places: Array, rng: np.random.Generator) -> Trial:
    """Draw one repetition; `places` (3,) are the objects' x positions in metres."""
    items = parameters.objects.items
    target = [item.id for item in items].index(task.object_id)
    layout = draw_layout(parameters, actor, task.action, places, target, rng)
    draw_hand = _draw_aim if task.action == "point" else _draw_grasp
    return Trial(
        task=task,
        timing=draw_timing(parameters.trial, actor, task.action, rng),
        layout=layout,
        target=target,
        hand_m=draw_hand(parameters, actor, layout, target, rng),
        bulge_m=draw_bulge(parameters.trial, actor, rng),
        displacement_m=draw_displacement(parameters, task.action, layout, items[target], rng),
        finger_overlap_m=draw_uniform(rng, parameters.trial.finger_overlap_range_m),
        pause_s=draw_uniform(rng, parameters.pause.reset_range_s),
    )


def draw_timing(parameters: TrialParameters, actor: Actor, action: str, rng: np.random.Generator) -> Timing:
    """Draw the durations of the phases."""
    duration = float(
        np.clip(actor.tempo * draw_normal(rng, parameters.duration_mean_sd_s), *parameters.duration_range_s)
    )
    if action == "point":
        return Timing(duration, duration * draw_normal(rng, parameters.pointing_reach_share_mean_sd), 0.0, 0.0)
    shares = (parameters.reach_share_mean_sd, parameters.grasp_share_mean_sd, parameters.effect_share_mean_sd)
    return Timing(duration, *(duration * draw_normal(rng, share) for share in shares))


def draw_layout(
    parameters: Parameters, actor: Actor, action: str, places: Array, target: int | None, rng: np.random.Generator
) -> Layout:
    """Draw the layout; the target, if there is one, may stand on a riser; `places` (3,) are the objects' x in m."""
    objects, items = parameters.objects, parameters.objects.items
    risers = np.zeros(len(items))
    if rng.random() < RISER_PROBABILITY.get(action, parameters.trial.riser_probability) and target is not None:
        risers[target] = draw_uniform(rng, parameters.trial.riser_height_range_m)
    heights = np.array([item.size_m[1] for item in items])
    x = places + draw_normals(rng, objects.place_jitter_x_sd_m, len(items))
    z = rng.uniform(*objects.place_z_range_m, size=len(items))
    aside_m, ahead_m = draw_normals(rng, parameters.trial.stance_sd_m, 2)
    hips_y_m = parameters.camera.height_m - HIP_HEIGHT * actor.height_m
    pelvis = np.array([actor.stand_x_m + aside_m, hips_y_m, parameters.table.far_z_m + actor.stand_off_m + ahead_m])
    return Layout(
        positions_m=np.stack([x, parameters.table_y_m - risers - heights / 2, z], axis=-1),
        yaw_rad=np.deg2rad(draw_normals(rng, objects.yaw_sd_deg, len(items))),
        riser_heights_m=risers,
        pelvis_m=pelvis,
        heading_rad=actor.heading_rad + np.deg2rad(draw_normal(rng, (0.0, parameters.trial.heading_sd_deg))),
        rest_m=np.stack([_draw_rest(parameters, pelvis[0], side, rng) for side in (1, -1)]),
    )


def _draw_rest(parameters: Parameters, middle_x_m: float, side: int, rng: np.random.Generator) -> Array:
    """Draw the position (3,) of a resting palm: on the table, near its far edge."""
    trial = parameters.trial
    x, height = draw_normals(rng, trial.rest_sd_m, 2)
    inset = draw_uniform(rng, trial.rest_inset_range_m)
    y = parameters.table_y_m - trial.rest_height_m - abs(height)
    return np.array([middle_x_m + side * trial.rest_side_m + x, y, parameters.table.far_z_m - inset])


def draw_bulge(parameters: TrialParameters, actor: Actor, rng: np.random.Generator) -> Array:
    """Draw the deviation (3,; m, camera frame) of the reach from a straight line: upward, and a little to a side."""
    up = actor.arc_scale * draw_uniform(rng, parameters.arc_height_range_m)
    return np.array([draw_normal(rng, (0.0, parameters.arc_side_sd_m)), -up, 0.0])


def _draw_grasp(parameters: Parameters, actor: Actor, layout: Layout, target: int, rng: np.random.Generator) -> Array:
    """Draw the position (3,) at which the palm grasps the object: on its top, towards the acting hand's side."""
    trial = parameters.trial
    width, height, depth = parameters.objects.items[target].size_m
    angle = np.deg2rad(draw_uniform(rng, trial.grasp_side_range_deg))
    sin, cos = np.sin(angle), np.cos(angle)
    out = min(width / 2 / max(abs(sin), 1e-9), height / 2 / cos) + trial.grasp_clearance_m
    offset = np.array([actor.side * sin * out, -cos * out, depth / 2])
    return np.asarray(layout.positions_m[target] + offset + draw_normals(rng, trial.grasp_sd_m, 3))


def _draw_aim(parameters: Parameters, actor: Actor, layout: Layout, target: int, rng: np.random.Generator) -> Array:
    """Draw the palm's final position (3,) in pointing, with the person's constant error and a random one."""
    trial = parameters.trial
    stance = Stance(layout.pelvis_m[None], np.array([layout.heading_rad]), np.array([actor.lean_rad]))
    error = actor.bias_rad + np.deg2rad(draw_normals(rng, trial.pointing_sd_deg, 2))
    stand_off = draw_uniform(rng, trial.pointing_stand_off_range_m)
    return pointing_palm(actor, stance, layout.rest_m[None], layout.positions_m[target], error, stand_off)


def draw_displacement(
    parameters: Parameters, action: str, layout: Layout, item: ObjectItem, rng: np.random.Generator
) -> Array:
    """Draw the displacement (3,; m, camera frame) of the object by the action, in the person's directions."""
    trial = parameters.trial
    angle = layout.heading_rad + np.deg2rad(draw_normal(rng, (0.0, trial.effect_direction_sd_deg)))
    away = np.array([-np.sin(angle), 0.0, -np.cos(angle)])
    far = draw_uniform(rng, trial.effect_distance_range_m)
    match action:
        case "push":
            return np.asarray(far * away)
        case "pull":
            return np.asarray(-draw_uniform(rng, trial.pull_distance_range_m) * away)
        case "lift":
            return np.array([0.0, -far, 0.0]) + draw_normals(rng, 0.1 * far, 3) * (1, 0, 1)
        case "put":
            drop = np.array([0.0, float(layout.riser_heights_m.max()), 0.0])
            return np.asarray((item.size_m[2] + trial.put_clearance_m) * away + drop)
        case _:
            return np.zeros(3)
