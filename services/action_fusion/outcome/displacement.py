"""The outcome for an object, from its displacement in the actor's level frame: lifted, pushed, 0.21 m right."""

from typing import Any

import numpy as np

from action_fusion.choice.evidence import Evidence
from action_fusion.tracks.actors import Actor
from action_fusion.tracks.object_tracks import ObjectTrack
from actum import geometry
from actum.arrays import Array
from actum.messages import Motion
from actum.node import SECOND_NS

DIRECTIONS = (("right", "left"), ("up", "down"), ("away", "towards"))
"""Words for a positive and a negative displacement along right, up and forward."""

UNMOVED = "unmoved"

MOVED = "moved"
"""Outcome of a displacement along the surface and sideways."""

PUSHED = "pushed"
"""Outcome of a displacement along the surface and away from the actor."""
PULLED = "pulled"
"""Outcome of a displacement along the surface and towards the actor."""

STEEPEST_SURFACE = 0.25
"""Largest rise along a surface, as a share of the path: a table seen by a tilted camera is flatter."""

FACING_NS = 2 * SECOND_NS
"""Nanoseconds from the start over which the facing direction is averaged: in one posture it is degrees off."""

SMALLEST_FORWARD = 1e-3
"""Least horizontal length of a unit vector: one with less points up or down within 0.06 degrees."""


def described(track: ObjectTrack | None, evidence: Evidence) -> dict[str, Any]:
    """Return an event's fields `motion`, `result`, `outcome` and `agrees` (with the expected outcome) for an object.

    They are measured in the actor's level frame at the segment's start, up to the turn of an object that came back. The
    result tells the direction in which the object was displaced most, e.g. "0.21 m away", or "unmoved".
    """
    level_from_camera = None if track is None else _level_from_camera(evidence.actor)
    if track is None or level_from_camera is None:
        return {"motion": None, "result": None, "outcome": None, "agrees": None}
    action, moved_m, has_front = evidence.action, evidence.settings.moved_m, evidence.actor.bodies[0].has_front
    displacement_m = level_from_camera @ track.displacement_m(moved_m)
    turn = track.turn(moved_m)
    turn_ns = None if turn is None else action.start_ns + int(track.stamps_ns[turn])
    name = outcome(displacement_m, moved_m, has_front)
    direction = _direction(displacement_m, moved_m, has_front)
    return {
        "motion": Motion(displacement_m=displacement_m.tolist(), direction=direction, turn_ns=turn_ns),
        "result": UNMOVED if direction is None else f"{float(np.abs(displacement_m).max()):.2f} m {direction}",
        "outcome": name,
        "agrees": _agrees(name, evidence.settings.expected_outcomes.get(str(action.action))),
    }


def outcome(displacement_m: Array, moved_m: float, has_front: bool) -> str:
    """Name the outcome for the object: lifted, put down, pushed, pulled, moved or unmoved.

    Args:
        displacement_m: (3,), right, up, forward of the actor.
        moved_m: a shorter displacement counts as unmoved.
        has_front: whether forward is the actor's facing direction; if not, horizontal directions are "sideways".
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


def _level_from_camera(actor: Actor) -> Array | None:
    """Build the actor's level frame as a rotation (3, 3): rows right, up, forward in the camera frame.

    Up is against gravity at the first posture; forward is the facing direction, averaged over `FACING_NS` and
    projected onto the horizontal; right = forward x up. None where the actor faces straight up or down.
    """
    up_in_camera = np.array(actor.bodies[0].up_in_camera)
    up = up_in_camera / np.linalg.norm(up_in_camera)
    early = actor.stamps_ns <= actor.stamps_ns[0] + FACING_NS
    facing = np.mean(actor.ego_from_camera[early, 2, :3], axis=0)
    horizontal = facing - (facing @ up) * up
    length = float(np.linalg.norm(horizontal))
    if length < SMALLEST_FORWARD:
        return None
    forward = horizontal / length
    return np.array([geometry.cross(forward.tolist(), up.tolist()), up, forward])


def _direction(displacement_m: Array, moved_m: float, has_front: bool) -> str | None:
    """Name the direction in which the object was displaced most; None where it is unmoved."""
    if float(np.linalg.norm(displacement_m)) < moved_m:
        return None
    axis = int(np.argmax(np.abs(displacement_m)))
    return DIRECTIONS[axis][float(displacement_m[axis]) < 0] if has_front or axis == 1 else "sideways"


def _agrees(name: str, expected: str | None) -> bool | None:
    """Tell whether an outcome is the expected one; None where none is expected, or for pushes and pulls sideways."""
    if expected is None or (name == MOVED and expected in (PUSHED, PULLED)):
        return None
    return name == expected
