"""The map of arms: which ways of holding and moving an arm the default recogniser knows."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.skeletons import INDEX
from actum.som import Som
from actum_model_inspector.bodies import MIDDLE_M, STANDING, Floats, Pen, draw_arrows, draw_bodies, rest
from actum_model_inspector.posture_map import draw_ground, drawn_units, map_size, name_sides, which_are_drawn
from actum_model_inspector.style import FAINT, canvas, in_house_style
from som_classifier.first_layer import VELOCITY_WEIGHT
from som_classifier.handedness import mirrored
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

CLOSER, CLOSE_UP_ARROW_M = 1.45, 0.5
"""How much larger than its unit a figure would be if it had legs, and the longest arrow on it."""
ARROW_IN = 0.018

_SHOULDER, _ENDS = INDEX["right_shoulder"], [INDEX["right_elbow"], INDEX["right_hand"]]
_LEGS = [INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("knee", "foot")]
_BUST = STANDING - STANDING[_SHOULDER] + np.array([-0.1, MIDDLE_M, 0.0])
_BUST[_LEGS] = np.nan


@dataclass(frozen=True, eq=False)
class ArmsOnBodies:
    """Arms as the map's units hold them, on bodies from elsewhere; each (n, 15, 3), metres.

    Attributes:
        others: the bodies without the right elbow and hand, NaN there.
        arms: the right shoulder, elbow and hand, NaN elsewhere.
        steps_m: how far elbow and hand go, seen from the shoulder, in the time that velocities stand for.
    """

    others: Floats
    arms: Floats
    steps_m: Floats

    @classmethod
    def of(cls, units: Floats, bodies: Floats) -> "ArmsOnBodies":
        """Put the arms that units (n, 12) hold on bodies (n, 15, 3)."""
        positions, velocities = np.moveaxis(units.reshape(-1, 2, 2, 3), 1, 0)
        others, arms = np.array(bodies, np.float64), np.full(bodies.shape, np.nan)
        steps_m = np.zeros(bodies.shape)
        others[:, _ENDS] = np.nan
        arms[:, _SHOULDER] = bodies[:, _SHOULDER]
        arms[:, _ENDS] = bodies[:, [_SHOULDER]] + positions
        steps_m[:, _ENDS] = velocities / VELOCITY_WEIGHT
        return cls(others, arms, steps_m)

    def in_a_mirror(self) -> "ArmsOnBodies":
        """Return the mirror image, where the left arm acts."""
        return ArmsOnBodies(mirrored(self.others), mirrored(self.arms), mirrored(self.steps_m))

    def draw(self, axes: Axes, places: Floats, size: float, lengthened: float) -> None:
        """Draw the arms with arrows, the steps lengthened, and the bodies faintly; places and size as `draw_bodies`."""
        draw_bodies(axes, self.others, places, size, pen=Pen(1.0, FAINT, 0.6))
        draw_bodies(axes, self.arms, places, size, pen=Pen(1.8))
        joints = np.where(np.isnan(self.arms), 0.0, self.arms)
        draw_arrows(axes, joints, self.steps_m * lengthened, places, size, ARROW_IN)


@in_house_style
def arm_map(arms: Som, mirrors: bool) -> Figure:
    """Draw each unit's weights as the right arm of somebody who stands and arrows at its joints, on the U-matrix.

    Where the model `mirrors`, they stand for a left arm that acts, too.
    """
    title = f"The map of arms: {arms.rows} × {arms.cols} units, each standing for where the arm is and where it goes"
    figure = canvas(*map_size(arms), title)
    axes = figure.add_subplot()
    draw_ground(axes, arms)
    units, every = drawn_units(arms)
    places = arms.coordinates[units][:, ::-1]
    fastest = fastest_m(arms)
    drawn = ArmsOnBodies.of(arms.weights[units], np.tile(_BUST, (len(units), 1, 1)))
    drawn.draw(axes, places, CLOSER * every, CLOSE_UP_ARROW_M / fastest)
    left = ", in a mirror a left one that acts" if mirrors else ""
    axes.set_title(
        f"{which_are_drawn(every)}the right arm{left}; arrows: where it goes, the longest at "
        f"{fastest / LAG_TIME_CONSTANT_S:.1f} m/s"
    )
    name_sides(axes)
    return figure


def fastest_m(arms: Som) -> float:
    """Return the longest step of all units, nowhere 0."""
    steps_m = ArmsOnBodies.of(arms.weights, rest(len(arms.weights))).steps_m
    return max(float(np.linalg.norm(steps_m, axis=-1).max()), 1e-9)
