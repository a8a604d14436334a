"""The palm's position in pointing: the fingertip lies on the line from the eye to the object."""

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX
from scene_simulator.actor import Actor
from scene_simulator.inverse_kinematics import Stance, eye, fingertip, pose

STRETCH = 0.97
"""Share of the length of arm and finger: people point with an arm that is not quite straight."""
ITERATIONS = 25
"""Fixed-point iterations: enough to converge to within rounding."""


def pointing_palm(
    actor: Actor, stance: Stance, hands_m: Array, target_m: Array, error_rad: Array, stand_off_m: float
) -> Array:
    """Return the palm's position (3,) in pointing at a target (3,); the other palm stays as in `hands_m` (1, 2, 3).

    The line from eye to fingertip misses the target by `error_rad` (azimuth, elevation); the fingertip stops
    `stand_off_m` before the target, or where the arm is stretched. Trunk and eye move with the hand, so the position
    is found by fixed-point iteration.
    """
    hands, column = hands_m.copy(), actor.column
    hands[0, column] = (hands[0, column] + target_m) / 2
    for _ in range(ITERATIONS):
        joints = pose(actor, stance, hands)
        eye_m = eye(actor, stance, joints)[0]
        ray = target_m - eye_m
        side = np.cross(ray, [0.0, -1.0, 0.0])
        side /= np.linalg.norm(side)
        length = np.linalg.norm(ray)
        over = np.cross(side, ray / length)
        turned = ray / length + np.tan(error_rad[0]) * side + np.tan(error_rad[1]) * over
        tip = _tip_on_ray(actor, eye_m, joints[0], length * turned / np.linalg.norm(turned), stand_off_m)
        hands[0, column] = tip - (fingertip(actor, joints) - joints[:, INDEX[f"{actor.hand}_hand"]])[0]
    return np.asarray(hands[0, column])


def _tip_on_ray(actor: Actor, eye_m: Array, joints_m: Array, ray: Array, stand_off_m: float) -> Array:
    """Return the fingertip (3,) on the ray (3,): before the target, or where the stretched arm meets the ray."""
    length = float(np.linalg.norm(ray))
    direction = ray / length
    offset = eye_m - joints_m[INDEX[f"{actor.hand}_shoulder"]]
    reach = STRETCH * (actor.arm_m + actor.finger_m)
    along = float(offset @ direction)
    stretched = -along + np.sqrt(max(along**2 - float(offset @ offset) + reach**2, 0.0))
    return np.asarray(eye_m + min(length - stand_off_m, stretched) * direction)
