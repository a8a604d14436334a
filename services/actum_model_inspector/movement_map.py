"""The map of velocities: which ways of moving the default recogniser knows."""

import numpy as np
from matplotlib.figure import Figure

from actum.som import Som
from actum_model_inspector.bodies import LONGEST_ARROW_M, Floats, Pen, draw_arrows, draw_bodies, rest
from actum_model_inspector.posture_map import FILLED, draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.style import FAINT, canvas, in_house_style
from som_classifier.kinematics import LAG_TIME_CONSTANT_S


@in_house_style
def movement_map(velocities: Som) -> Figure:
    """Draw each unit's weights as arrows at the joints of somebody who stands, on the U-matrix."""
    title = f"The movement map: {velocities.rows} × {velocities.cols} units, each standing for a way of moving"
    figure = canvas(*map_size(velocities), title)
    axes = figure.add_subplot()
    draw_ground(axes, velocities)
    units, every = drawn_units(velocities)
    places = velocities.coordinates[units][:, ::-1]
    bodies = rest(len(units))
    draw_bodies(axes, bodies, places, FILLED * every, pen=Pen(0.7, FAINT, 0.6))
    speeds_mps, steps_m = arrows_of(velocities)
    draw_arrows(axes, bodies, steps_m[units], places, FILLED * every, width_in=0.016)
    axes.set_title(
        f"{which_are_drawn(every)}arrows: where each joint is going, whatever the posture, the longest at "
        f"{speeds_mps.max():.1f} m/s; none: at rest"
    )
    name_sides(axes)
    return figure


def arrows_of(velocities: Som) -> tuple[Floats, Floats]:
    """Return how fast each unit's joints are, (units, 15), and the arrows that show it, (units, 15, 3), metres."""
    ahead = velocities.weights.reshape(len(velocities.weights), -1, 3)
    lengths = np.linalg.norm(ahead, axis=-1)
    return lengths / LAG_TIME_CONSTANT_S, ahead * (LONGEST_ARROW_M / max(float(lengths.max()), 1e-9))
