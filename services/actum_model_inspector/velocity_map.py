"""The picture of the default recogniser's velocity map, with arrows on somebody who stands."""

import numpy as np
from matplotlib.figure import Figure

from actum.som import Som
from actum_model_inspector.posture_map import FILLED, draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.stick_figures import LONGEST_ARROW_M, Pen, draw_arrows, draw_figures, standing
from actum_model_inspector.style import FAINT, figure_with_layout, in_house_style
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

ARROW_IN = 0.016  # width of the arrows' shafts


@in_house_style()
def velocity_map(velocities: Som) -> Figure:
    """Draw each unit's weights as arrows at the joints of somebody who stands, on the U-matrix.

    The weights are velocities as displacements (m) within `LAG_TIME_CONSTANT_S`.
    """
    title = f"The movement map: {velocities.rows} × {velocities.cols} units, each standing for a way of moving"
    figure = figure_with_layout(*map_size(velocities), title)
    axes = figure.add_subplot()
    draw_ground(axes, velocities)
    units, spacing = drawn_units(velocities)
    places = velocities.coordinates[units][:, ::-1]
    bodies = standing(len(units))
    draw_figures(axes, bodies, places, FILLED * spacing, pen=Pen(0.7, FAINT, 0.6))
    steps_m = velocities.weights.reshape(len(velocities.weights), -1, 3)
    fastest_m = float(np.linalg.norm(steps_m, axis=-1).max())
    arrows_m = steps_m * (LONGEST_ARROW_M / max(fastest_m, 1e-9))
    draw_arrows(axes, bodies, arrows_m[units], places, FILLED * spacing, ARROW_IN)
    axes.set_title(
        f"{which_are_drawn(spacing)}arrows: where each joint is going, whatever the posture, the longest at "
        f"{fastest_m / LAG_TIME_CONSTANT_S:.1f} m/s; none: at rest"
    )
    name_sides(axes)
    return figure
