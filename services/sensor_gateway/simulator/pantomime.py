"""An action done in empty space, as if an object were there."""

import numpy as np

from sensor_gateway.simulator.actor import Actor
from sensor_gateway.simulator.chance import uniform
from sensor_gateway.simulator.motion import Array
from sensor_gateway.simulator.parameters import Parameters
from sensor_gateway.simulator.programme import Sample
from sensor_gateway.simulator.trial import Layout, Trial, draw_bulge, draw_displacement, draw_layout, draw_timing

CLEAR_M = 0.37
"""So far from every object's middle the hand acts, all the way."""

ASIDE_RANGE_M = (0.0, 0.70)
ABOVE_RANGE_M = (0.08, 0.50)
AHEAD_RANGE_M = (0.20, 0.65)
"""Where it acts: to the acting hand's side of the person, above the table, before the person."""

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
    lowest_y_m = parameters.table_y_m - ABOVE_RANGE_M[0]
    for _ in range(TRIES):
        aside, above, ahead = (uniform(rng, one) for one in (ASIDE_RANGE_M, ABOVE_RANGE_M, AHEAD_RANGE_M))
        x, z = layout.pelvis_m[0] + actor.side * aside, layout.pelvis_m[2] - ahead
        place = np.array([x, parameters.table_y_m - above, z])
        if _is_clear(place, displacement_m, layout.positions_m) and place[1] + displacement_m[1] <= lowest_y_m:
            return place
    raise ValueError("no empty space for a pantomime: put the objects closer together")


def _is_clear(place: Array, displacement_m: Array, positions_m: Array) -> bool:
    way = place + np.linspace(0, 1, 8)[:, None] * displacement_m
    return bool(np.linalg.norm(way[:, None] - positions_m, axis=2).min() >= CLEAR_M)
