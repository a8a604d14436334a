"""An action done in empty space, as if an object were there."""

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Actor
from scene_simulator.chance import uniform
from scene_simulator.parameters import Parameters
from scene_simulator.programme import Sample
from scene_simulator.trial import Layout, Trial, draw_bulge, draw_displacement, draw_layout, draw_timing

TRIES = 10_000


def draw_pantomime(
    parameters: Parameters, actor: Actor, sample: Sample, places: Array, rng: np.random.Generator
) -> Trial:
    """Draw one repetition of an action without its object; the objects (3,) stand at their lanes.

    Raises:
        ValueError: there is no empty space within the person's reach.
    """
    layout = draw_layout(parameters, actor, sample.action, places, None, rng)
    imagined = parameters.objects.items[rng.integers(len(parameters.objects.items))]
    displacement = draw_displacement(parameters, sample.action, layout, imagined, rng)
    if sample.action == "put":
        displacement[1] = uniform(rng, parameters.trial.riser_height_range_m)
    return Trial(
        sample=sample,
        timing=draw_timing(parameters.trial, actor, sample.action, rng),
        layout=layout,
        target=None,
        hand_m=_draw_empty_place(parameters, actor, layout, displacement, rng),
        bulge_m=draw_bulge(parameters.trial, actor, rng),
        displacement_m=displacement,
        finger_overlap_m=0.0,
        pause_s=uniform(rng, parameters.pause.reset_range_s),
    )


def _draw_empty_place(
    parameters: Parameters, actor: Actor, layout: Layout, displacement_m: Array, rng: np.random.Generator
) -> Array:
    """Draw where the palm is when it takes nothing."""
    where = parameters.pantomime
    lowest_y_m = parameters.table_y_m - where.above_range_m[0]
    for _ in range(TRIES):
        ranges_m = (where.aside_range_m, where.above_range_m, where.ahead_range_m)
        aside, above, ahead = (uniform(rng, one) for one in ranges_m)
        x, z = layout.pelvis_m[0] + actor.side * aside, layout.pelvis_m[2] - ahead
        place = np.array([x, parameters.table_y_m - above, z])
        nearest_m = _nearest_m(place, displacement_m, layout.positions_m)
        is_there = where.clear_range_m[0] <= nearest_m <= where.clear_range_m[1]
        if is_there and place[1] + displacement_m[1] <= lowest_y_m:
            return place
    raise ValueError("no empty space for a pantomime: put the objects closer together, or the pantomime nearer")


def _nearest_m(place: Array, displacement_m: Array, positions_m: Array) -> float:
    """Measure how near the palm comes to an object's middle from where it takes nothing to where it leaves it."""
    way = place + np.linspace(0, 1, 8)[:, None] * displacement_m
    return float(np.linalg.norm(way[:, None] - positions_m, axis=2).min())
