"""The picture of the default recogniser's velocity map, with arrows on somebody who stands."""

import numpy as np
from matplotlib.figure import Figure

from actum.arrays import Floats
from actum.som import Som
from actum_model_inspector.posture_map import FILLED, draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.stick_figures import LONGEST_ARROW_M, Pen, draw_arrows, draw_figures, standing
from actum_model_inspector.style import FAINT, figure_with_layout, in_house_style
from som_classifier.kinematics import LAG_TIME_CONSTANT_S


@in_house_style
def velocity_map(velocities: Som) -> Figure:
    """Draw each unit's weights as arrows at the joints of somebody who stands, on the U-matrix."""
    title = f"The movement map: {velocities.rows} × {velocities.cols} units, each standing for a way of moving"
    figure = figure_with_layout(*map_size(velocities), title)
    axes = figure.add_subplot()
    draw_ground(axes, velocities)
    units, spacing = drawn_units(velocities)
    places = velocities.coordinates[units][:, ::-1]
    bodies = standing(len(units))
    draw_figures(axes, bodies, places, FILLED * spacing, pen=Pen(0.7, FAINT, 0.6))
    speeds_mps, steps_m = velocity_arrows(velocities)
    draw_arrows(axes, bodies, steps_m[units], places, FILLED * spacing, width_in=0.016)
    axes.set_title(
        f"{which_are_drawn(spacing)}arrows: where each joint is going, whatever the posture, the longest at "
        f"{speeds_mps.max():.1f} m/s; none: at rest"
    )
    name_sides(axes)
    return figure


def velocity_arrows(velocities: Som) -> tuple[Floats, Floats]:
    """Return the speed of each unit's joints, m/s, (units, 15), and arrows that show it, metres, (units, 15, 3).

    The weights are velocities as displacements (m) within `LAG_TIME_CONSTANT_S`.
    """
    steps_m = velocities.weights.reshape(len(velocities.weights), -1, 3)
    lengths_m = np.linalg.norm(steps_m, axis=-1)
    return lengths_m / LAG_TIME_CONSTANT_S, steps_m * (LONGEST_ARROW_M / max(float(lengths_m.max()), 1e-9))
