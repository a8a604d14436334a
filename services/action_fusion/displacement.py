"""What became of an object, from its displacement in the actor's level frame: lifted, pushed, 0.21 m right."""

from typing import Any

import numpy as np

from actum.arrays import Array
from actum.messages import Motion

DIRECTIONS = (("right", "left"), ("up", "down"), ("away", "towards"))
"""Words for a positive and a negative displacement along right, up and forward."""

UNMOVED = "unmoved"

MOVED = "moved"
"""Along the surface and sideways: neither away from the actor nor towards."""

PUSHED = "pushed"
"""What became of a thing that went away from the actor …"""
PULLED = "pulled"
"""… and towards them."""

STEEPEST_SURFACE = 0.25
"""What rises by more than a quarter of its way has left the surface: a table seen by a tilted camera is flatter."""


def described(displacement_m: Array, moved_m: float, has_front: bool, expected: str | None) -> dict[str, Any]:
    """Describe a displacement as events do: `motion`, `result`, `outcome`, and whether it `agrees` with the expected.

    The result tells the axis on which the object was displaced most, e.g. "0.21 m away", or "unmoved".

    Args:
        displacement_m: (3,), right, up, forward of the actor.
        moved_m: less is no displacement.
        has_front: whether forward is the actor's own; if not, all that is level is sideways.
        expected: the outcome that the action is to have, if it is to have one.
    """
    became = outcome(displacement_m, moved_m, has_front)
    direction = _direction(displacement_m, moved_m, has_front)
    return {
        "motion": Motion(displacement_m=displacement_m.tolist(), direction=direction),
        "result": UNMOVED if direction is None else f"{float(np.abs(displacement_m).max()):.2f} m {direction}",
        "outcome": became,
        "agrees": _agrees(became, expected),
    }


def outcome(displacement_m: Array, moved_m: float, has_front: bool = True) -> str:
    """Say what was done to the object: lifted, put down, pushed, pulled, moved or unmoved.

    Args as of `described`.
    """
    length = float(np.linalg.norm(displacement_m))
    if length < moved_m:
        return UNMOVED
    _, up, forward = map(float, displacement_m)
    if abs(up) >= max(moved_m, STEEPEST_SURFACE * length):
        return "lifted" if up > 0 else "put down"
    if _direction(displacement_m, moved_m, has_front) in DIRECTIONS[2]:
        return PUSHED if forward > 0 else PULLED
    return MOVED


def _direction(displacement_m: Array, moved_m: float, has_front: bool) -> str | None:
    """Name the direction in which the object was displaced most; None where it was not."""
    if float(np.linalg.norm(displacement_m)) < moved_m:
        return None
    axis = int(np.argmax(np.abs(displacement_m)))
    return DIRECTIONS[axis][float(displacement_m[axis]) < 0] if has_front or axis == 1 else "sideways"


def _agrees(became: str, expected: str | None) -> bool | None:
    """Tell whether an outcome is the expected one; None where none is, or where it may be: things are pushed aside."""
    if expected is None or (became == MOVED and expected in (PUSHED, PULLED)):
        return None
    return became == expected
