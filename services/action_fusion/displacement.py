"""How an object moved as the actor would put it: right or left, up or down, away or towards."""

import numpy as np

from action_fusion.samples import Array

DIRECTIONS = (("right", "left"), ("up", "down"), ("away", "towards"))
"""Words for a positive and a negative step along right, up and forward."""

_SMALLEST = 1e-3


def level_from_camera(ego_from_camera: Array, up_in_camera: Array) -> Array | None:
    """Build the level frame of a posture as a rotation (3, 3): rows right, up, forward in the camera frame.

    Up is against gravity, forward the actor's own made horizontal, right = forward x up. None where the actor
    faces straight up or down.
    """
    up = up_in_camera / np.linalg.norm(up_in_camera)
    facing = ego_from_camera[2, :3]
    level = facing - (facing @ up) * up
    length = float(np.linalg.norm(level))
    if length < _SMALLEST:
        return None
    forward = level / length
    return np.stack([np.cross(forward, up), up, forward])


def result(displacement_m: Array, moved_m: float) -> str:
    """Say how the object moved along the axis on which it moved most, e.g. "0.21 m away", or "unmoved"."""
    if float(np.linalg.norm(displacement_m)) < moved_m:
        return "unmoved"
    axis = int(np.argmax(np.abs(displacement_m)))
    step = float(displacement_m[axis])
    return f"{abs(step):.2f} m {DIRECTIONS[axis][step < 0]}"
