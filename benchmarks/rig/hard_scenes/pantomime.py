"""Pantomimes: actions done in empty space, as if an object were there."""

from dataclasses import dataclass, field

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Actor
from scene_simulator.parameters import Pair, Parameters
from scene_simulator.programme import ACTIONS, Task
from scene_simulator.random_streams import draw_uniform
from scene_simulator.trial import Layout, Trial, draw_bulge, draw_displacement, draw_layout, draw_timing

NO_OBJECT = -1
"""Object id of a pantomime in its `Truth`."""
FAR_M = (0.37, 2.0)
"""Range of the smallest distance of the palm's path from any object's middle, if no condition asks for another."""
ASIDE_RANGE_M = (0.0, 0.70)
"""Range of the palm's distance to the acting hand's side of the person."""
ABOVE_RANGE_M = (0.08, 0.50)
"""Range of the palm's height above the table."""
AHEAD_RANGE_M = (0.20, 0.65)
"""Range of the palm's distance in front of the person."""
TRIES = 10_000
"""Positions drawn before a scene counts as too full: a small empty region is still found."""


@dataclass(frozen=True)
class Pantomime(Task):
    """The task of one repetition in empty space, of an action of `ACTIONS` that touches an object.

    Raises:
        ValueError: there is no such action, or it is pointing.
    """

    object_id: int = field(default=NO_OBJECT, init=False)

    def __post_init__(self) -> None:
        if self.action not in ACTIONS or self.action == "point":
            raise ValueError(f"{self.action!r} has no pantomime: choose an action that touches an object")


def draw_pantomime(
    parameters: Parameters,
    actor: Actor,
    task: Pantomime,
    places: Array,
    clear_range_m: Pair,
    rng: np.random.Generator,
) -> Trial:
    """Draw one repetition of an action without its object, whose `target` is the object that is imagined.

    `places` (3,) are the objects' x positions in metres, `clear_range_m` is the range of the smallest distance of the
    palm's path from any object's middle.

    Raises:
        ValueError: there is no empty space within the person's reach.
    """
    layout = draw_layout(parameters, actor, task.action, places, None, rng)
    imagined = int(rng.integers(len(parameters.objects.items)))
    displacement = draw_displacement(parameters, task.action, layout, parameters.objects.items[imagined], rng)
    if task.action == "put":
        displacement[1] = draw_uniform(rng, parameters.trial.riser_height_range_m)
    return Trial(
        task=task,
        timing=draw_timing(parameters.trial, actor, task.action, rng),
        layout=layout,
        target=imagined,
        hand_m=_draw_empty_place(parameters, actor, layout, displacement, clear_range_m, rng),
        bulge_m=draw_bulge(parameters.trial, actor, rng),
        displacement_m=displacement,
        finger_overlap_m=0.0,
        pause_s=draw_uniform(rng, parameters.pause.reset_range_s),
    )


def _draw_empty_place(
    parameters: Parameters,
    actor: Actor,
    layout: Layout,
    displacement_m: Array,
    clear_range_m: Pair,
    rng: np.random.Generator,
) -> Array:
    """Draw the palm's position (3,) at the imagined grasp, far enough from all objects, by rejection sampling."""
    lowest_y_m = parameters.table_y_m - ABOVE_RANGE_M[0]
    for _ in range(TRIES):
        aside, above, ahead = (draw_uniform(rng, one) for one in (ASIDE_RANGE_M, ABOVE_RANGE_M, AHEAD_RANGE_M))
        x, z = layout.pelvis_m[0] + actor.side * aside, layout.pelvis_m[2] - ahead
        place = np.array([x, parameters.table_y_m - above, z])
        path = place + np.linspace(0, 1, 8)[:, None] * displacement_m
        nearest_m = float(np.linalg.norm(path[:, None] - layout.positions_m, axis=2).min())
        is_clear = clear_range_m[0] <= nearest_m <= clear_range_m[1]
        if is_clear and place[1] + displacement_m[1] <= lowest_y_m:
            return place
    raise ValueError(
        "there is no empty space for a pantomime (an action without an object): move the objects closer together"
    )
