"""The picture of the default recogniser's arm map: positions and velocities of an arm relative to its shoulder."""

import numpy as np
from matplotlib.figure import Figure

from actum.arrays import Floats
from actum.skeletons import INDEX
from actum.som import Som
from actum_model_inspector.posture_map import draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.stick_figures import MIDDLE_M, STANDING, Pen, draw_arrows, draw_figures
from actum_model_inspector.style import FAINT, figure_with_layout, in_house_style
from som_classifier.first_layer import VELOCITY_WEIGHT
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

FIGURE_SIZE = 1.45  # units of the map: figures have no legs here and may be larger
LONGEST_STEP_M = 0.5  # of the fastest arm's arrow on a figure: it stays about within its unit
ARROW_IN = 0.018  # width of the arrows' shafts

_SHOULDER = INDEX["right_shoulder"]
_ENDS = [INDEX["right_elbow"], INDEX["right_hand"]]
_LEGS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("knee", "foot")]
_ARMLESS = STANDING - STANDING[_SHOULDER] + np.array([-0.1, MIDDLE_M, 0.0])
_ARMLESS[_LEGS + _ENDS] = np.nan
"""Joints of somebody who stands, without legs and right arm, (15, 3), metres from the middle of a unit's place."""


@in_house_style()
def arm_map(arms: Som, mirrors: bool) -> Figure:
    """Draw each unit's weights on the U-matrix: a right arm of somebody who stands, with arrows at its joints.

    Where the model `mirrors`, a unit stands for the mirror image of a left arm, too.
    """
    title = f"The map of arms: {arms.rows} × {arms.cols} units, each standing for where the arm is and where it goes"
    figure = figure_with_layout(*map_size(arms), title)
    axes = figure.add_subplot()
    draw_ground(axes, arms)
    units, spacing = drawn_units(arms)
    places, size = arms.coordinates[units][:, ::-1], FIGURE_SIZE * spacing
    joints, steps_m = arm_joints(arms.weights), arm_steps_m(arms.weights)
    fastest_m = float(np.linalg.norm(steps_m, axis=-1).max())
    arrows_m = steps_m * (LONGEST_STEP_M / max(fastest_m, 1e-9))
    draw_figures(axes, np.tile(_ARMLESS, (len(units), 1, 1)), places, size, pen=Pen(1.0, FAINT, 0.6))
    draw_figures(axes, joints[units], places, size, pen=Pen(1.8))
    draw_arrows(axes, np.nan_to_num(joints[units]), arrows_m[units], places, size, ARROW_IN)
    left = ", in a mirror a left one that acts" if mirrors else ""
    axes.set_title(
        f"{which_are_drawn(spacing)}the right arm{left}; arrows: where it goes, the longest at "
        f"{fastest_m / LAG_TIME_CONSTANT_S:.1f} m/s"
    )
    name_sides(axes)
    return figure


def arm_joints(units: Floats) -> Floats:
    """Return the right shoulder, elbow and hand of units (n, 12), metres, NaN for other joints. Shape (n, 15, 3)."""
    joints = np.full((len(units), *_ARMLESS.shape), np.nan)
    joints[:, _SHOULDER] = _ARMLESS[_SHOULDER]
    joints[:, _ENDS] = _ARMLESS[_SHOULDER] + units.reshape(-1, 2, 2, 3)[:, 0]
    return joints


def arm_steps_m(units: Floats) -> Floats:
    """Return how far elbow and hand of units (n, 12) move from the shoulder within `LAG_TIME_CONSTANT_S`, (n, 15, 3).

    It is 0 for other joints.
    """
    steps_m = np.zeros((len(units), *_ARMLESS.shape))
    steps_m[:, _ENDS] = units.reshape(-1, 2, 2, 3)[:, 1] / VELOCITY_WEIGHT
    return steps_m
