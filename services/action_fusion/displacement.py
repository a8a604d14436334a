"""How an object moved as the actor would put it: right or left, up or down, away or towards."""

import numpy as np

from action_fusion.samples import Array

DIRECTIONS = (("right", "left"), ("up", "down"), ("away", "towards"))
"""Words for a positive and a negative step along right, up and forward."""

UNMOVED = "unmoved"
MOVED = "moved"
"""Along the surface and sideways: neither away from the actor nor towards."""
PUSHED, PULLED = "pushed", "pulled"

STEEPEST_SURFACE = 0.25
"""What rises by more than a quarter of its way has left the surface: a table seen by a tilted camera is flatter."""

_SMALLEST = 1e-3


def level_from_camera(facing: Array, up_in_camera: Array) -> Array | None:
    """Build an actor's level frame as a rotation (3, 3): rows right, up, forward in the camera frame.

    Up is against gravity, forward where the actor faces (3,) made horizontal, right = forward x up. None where the
    actor faces straight up or down.
    """
    up = up_in_camera / np.linalg.norm(up_in_camera)
    level = facing - (facing @ up) * up
    length = float(np.linalg.norm(level))
    if length < _SMALLEST:
        return None
    forward = level / length
    return np.stack([np.cross(forward, up), up, forward])


def direction(displacement_m: Array, moved_m: float, faces: bool = True) -> str | None:
    """Name the direction in which the object moved most; None where it did not move.

    Args:
        displacement_m: (3,), right, up, forward.
        moved_m: less is no motion.
        faces: whether forward is the actor's own; if not, all that is level is sideways.
    """
    if float(np.linalg.norm(displacement_m)) < moved_m:
        return None
    axis = int(np.argmax(np.abs(displacement_m)))
    return DIRECTIONS[axis][float(displacement_m[axis]) < 0] if faces or axis == 1 else "sideways"


def result(displacement_m: Array, moved_m: float, faces: bool = True) -> str:
    """Say how the object moved along the axis on which it moved most, e.g. "0.21 m away", or "unmoved"."""
    word = direction(displacement_m, moved_m, faces)
    return UNMOVED if word is None else f"{float(np.abs(displacement_m).max()):.2f} m {word}"


def outcome(displacement_m: Array, moved_m: float, faces: bool = True) -> str:
    """Say what was done to the object: lifted, put down, pushed, pulled, moved or unmoved.

    Args as of `direction`.
    """
    length = float(np.linalg.norm(displacement_m))
    if length < moved_m:
        return UNMOVED
    _, up, forward = map(float, displacement_m)
    if abs(up) >= max(moved_m, STEEPEST_SURFACE * length):
        return "lifted" if up > 0 else "put down"
    if direction(displacement_m, moved_m, faces) in DIRECTIONS[2]:
        return PUSHED if forward > 0 else PULLED
    return MOVED


def agrees(became: str, expected: str | None) -> bool | None:
    """Tell whether an outcome is the expected one; None where none is, or where it may be: things are pushed aside."""
    if expected is None or (became == MOVED and expected in (PUSHED, PULLED)):
        return None
    return became == expected
