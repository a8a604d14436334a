"""Pantomimes: actions done in empty space, as if an object were there."""

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Actor
from scene_simulator.parameters import Parameters
from scene_simulator.programme import Task
from scene_simulator.random_streams import draw_uniform
from scene_simulator.trial import Layout, Trial, draw_bulge, draw_displacement, draw_layout, draw_timing

TRIES = 10_000
"""Positions drawn before a scene counts as too full: a small empty region is still found."""


def draw_pantomime(parameters: Parameters, actor: Actor, task: Task, places: Array, rng: np.random.Generator) -> Trial:
    """Draw one repetition of an action without its object; `places` (3,) are the objects' x positions in metres.

    Raises:
        ValueError: there is no empty space within the person's reach.
    """
    layout = draw_layout(parameters, actor, task.action, places, None, rng)
    imagined = parameters.objects.items[rng.integers(len(parameters.objects.items))]
    displacement = draw_displacement(parameters, task.action, layout, imagined, rng)
    if task.action == "put":
        displacement[1] = draw_uniform(rng, parameters.trial.riser_height_range_m)
    return Trial(
        task=task,
        timing=draw_timing(parameters.trial, actor, task.action, rng),
        layout=layout,
        target=None,
        hand_m=_draw_empty_place(parameters, actor, layout, displacement, rng),
        bulge_m=draw_bulge(parameters.trial, actor, rng),
        displacement_m=displacement,
        finger_overlap_m=0.0,
        pause_s=draw_uniform(rng, parameters.pause.reset_range_s),
    )


def _draw_empty_place(
    parameters: Parameters, actor: Actor, layout: Layout, displacement_m: Array, rng: np.random.Generator
) -> Array:
    """Draw the palm's position (3,) at the imagined grasp, far enough from all objects, by rejection sampling."""
    region = parameters.pantomime
    lowest_y_m = parameters.table_y_m - region.above_range_m[0]
    for _ in range(TRIES):
        ranges_m = (region.aside_range_m, region.above_range_m, region.ahead_range_m)
        aside, above, ahead = (draw_uniform(rng, one) for one in ranges_m)
        x, z = layout.pelvis_m[0] + actor.side * aside, layout.pelvis_m[2] - ahead
        place = np.array([x, parameters.table_y_m - above, z])
        nearest_m = _nearest_m(place, displacement_m, layout.positions_m)
        is_clear = region.clear_range_m[0] <= nearest_m <= region.clear_range_m[1]
        if is_clear and place[1] + displacement_m[1] <= lowest_y_m:
            return place
    raise ValueError(
        "there is no empty space for a pantomime (an action without an object): move the objects closer together"
    )


def _nearest_m(place: Array, displacement_m: Array, positions_m: Array) -> float:
    """Return the palm's smallest distance from any object's middle between the imagined grasp and release."""
    path = place + np.linspace(0, 1, 8)[:, None] * displacement_m
    return float(np.linalg.norm(path[:, None] - positions_m, axis=2).min())
