"""The picture of the default recogniser's arm map: positions and velocities of an arm relative to its shoulder."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.arrays import Floats
from actum.skeletons import INDEX
from actum.som import Som
from actum_model_inspector.posture_map import draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.stick_figures import MIDDLE_M, STANDING, Pen, draw_arrows, draw_figures, standing
from actum_model_inspector.style import FAINT, figure_with_layout, in_house_style
from som_classifier.first_layer import VELOCITY_WEIGHT
from som_classifier.handedness import mirrored
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

FIGURE_SIZE = 1.45  # units of the map: figures have no legs here and may be larger
LONGEST_STEP_M = 0.5  # of the fastest arm's arrow on a figure: it stays about within its unit
ARROW_IN = 0.018  # width of the arrows' shafts

_SHOULDER = INDEX["right_shoulder"]
_ENDS = [INDEX["right_elbow"], INDEX["right_hand"]]
_LEGS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("knee", "foot")]
_BUST = STANDING - STANDING[_SHOULDER] + np.array([-0.1, MIDDLE_M, 0.0])
_BUST[_LEGS] = np.nan


@dataclass(frozen=True, eq=False)
class ArmsOnBodies:
    """Right arms from the units of the arm map, attached to given bodies; all (n, 15, 3), metres, NaN where not drawn.

    Attributes:
        bodies: the bodies without the right elbow and hand.
        arms: the right shoulder, elbow and hand alone.
        steps_m: how far elbow and hand move relative to the shoulder within `LAG_TIME_CONSTANT_S`, 0 elsewhere.
    """

    bodies: Floats
    arms: Floats
    steps_m: Floats

    @classmethod
    def of(cls, units: Floats, bodies: Floats) -> "ArmsOnBodies":
        """Attach the arms of units (n, 12) to bodies (n, 15, 3)."""
        positions, velocities = np.moveaxis(units.reshape(-1, 2, 2, 3), 1, 0)
        armless, arms = np.array(bodies, np.float64), np.full(bodies.shape, np.nan)
        steps_m = np.zeros(bodies.shape)
        armless[:, _ENDS] = np.nan
        arms[:, _SHOULDER] = bodies[:, _SHOULDER]
        arms[:, _ENDS] = bodies[:, [_SHOULDER]] + positions
        steps_m[:, _ENDS] = velocities / VELOCITY_WEIGHT
        return cls(armless, arms, steps_m)

    def mirrored(self) -> "ArmsOnBodies":
        """Return the mirror image: left arms."""
        return ArmsOnBodies(mirrored(self.bodies), mirrored(self.arms), mirrored(self.steps_m))

    def draw(self, axes: Axes, places: Floats, size: float, lengthened: float) -> None:
        """Draw the arms, faintly their bodies, and arrows: the steps times `lengthened`.

        Args:
            axes: whose y goes down.
            places: (n, 2), x and y of each figure's middle.
            size: how high a whole figure may be.
            lengthened: factor of the steps.
        """
        draw_figures(axes, self.bodies, places, size, pen=Pen(1.0, FAINT, 0.6))
        draw_figures(axes, self.arms, places, size, pen=Pen(1.8))
        joints = np.where(np.isnan(self.arms), 0.0, self.arms)
        draw_arrows(axes, joints, self.steps_m * lengthened, places, size, ARROW_IN)


@in_house_style
def arm_map(arms: Som, mirrors: bool) -> Figure:
    """Draw each unit's weights on the U-matrix: a right arm of somebody who stands, with arrows at its joints.

    Where the model `mirrors`, a unit stands for the mirror image of a left arm, too.
    """
    title = f"The map of arms: {arms.rows} × {arms.cols} units, each standing for where the arm is and where it goes"
    figure = figure_with_layout(*map_size(arms), title)
    axes = figure.add_subplot()
    draw_ground(axes, arms)
    units, spacing = drawn_units(arms)
    places = arms.coordinates[units][:, ::-1]
    fastest = fastest_m(arms)
    drawn = ArmsOnBodies.of(arms.weights[units], np.tile(_BUST, (len(units), 1, 1)))
    drawn.draw(axes, places, FIGURE_SIZE * spacing, LONGEST_STEP_M / fastest)
    left = ", in a mirror a left one that acts" if mirrors else ""
    axes.set_title(
        f"{which_are_drawn(spacing)}the right arm{left}; arrows: where it goes, the longest at "
        f"{fastest / LAG_TIME_CONSTANT_S:.1f} m/s"
    )
    name_sides(axes)
    return figure


def fastest_m(arms: Som) -> float:
    """Return the longest step of elbow or hand among all units, metres, at least 1e-9."""
    steps_m = ArmsOnBodies.of(arms.weights, standing(len(arms.weights))).steps_m
    return max(float(np.linalg.norm(steps_m, axis=-1).max()), 1e-9)
