"""From an action, its agent's postures and the objects' sightings to one event."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from action_fusion import displacement, proximity
from action_fusion.proximity import Actor
from action_fusion.samples import Array, ObjectsSample, PostureSample
from action_fusion.settings import Settings
from action_fusion.tracks import Track, tracks
from actum.messages import ActedObject, Action, Event, Hand, Motion

PART_HANDS: dict[str | None, Hand] = {"right_arm": "right", "left_arm": "left"}


@dataclass(frozen=True)
class Evidence:
    """What speaks for one object: how near which hand came, how well which arm points at it, how far it moved."""

    track: Track
    distance_m: float
    near_hand: Hand
    angle: float
    pointing_hand: Hand
    shift: Array


def fuse(
    action: Action, postures: Sequence[PostureSample], frames: Sequence[ObjectsSample], settings: Settings
) -> Event:
    """Tell what a recognised action was applied to, and what became of it.

    Args:
        action: a valid final action with label and end.
        postures: its agent's, with start <= stamp <= end.
        frames: the objects', from some time before the start up to the end.
        settings: thresholds and labels.
    """
    hands = _hands(action)
    actor = proximity.actor(postures, action.start_ns)
    seen = tracks(frames, action.start_ns)
    evidence = [] if actor is None else [_evidence(track, actor, hands) for track in seen]
    pointing = action.action in settings.pointing_labels
    chosen = _pointed_at(evidence, settings) if pointing else _acted_on(evidence, settings)
    motion = _motion(chosen, postures, settings)
    result = None if motion is None else displacement.result(np.array(motion.displacement_m), settings.moved_m)
    distances = {str(e.track.id): e.distance_m for e in evidence if math.isfinite(e.distance_m)}
    return Event(
        **_common(action),
        object=_acted_object(chosen),
        hand=_hand_of(chosen, pointing, hands),
        objects_present=[track.id for track in seen],
        distances_m=distances,
        motion=motion,
        result=result,
        sentence=_sentence(action, chosen, result, _absence(distances, pointing)),
        missed=action.missed + _gaps(postures),
    )


def rejected(action: Action, reason: str) -> Event:
    """Pass a rejection on, with its reason."""
    return Event(
        **_common(action),
        valid=False,
        reason=reason,
        object=None,
        hand=action.hand,
        objects_present=[],
        distances_m={},
        motion=None,
        result=None,
        sentence=f"no recognition: {reason}",
        missed=action.missed,
    )


def _common(action: Action) -> dict[str, Any]:
    """Copy what an event takes over from its action; nothing fills `held` in this version."""
    return {
        "stamp_ns": action.stamp_ns,
        "sensor": action.sensor,
        "agent": action.agent,
        "segment_id": action.segment_id,
        "start_ns": action.start_ns,
        "end_ns": action.start_ns if action.end_ns is None else action.end_ns,
        "action": action.action,
        "confidence": action.confidence,
        "unknown": action.unknown,
        "missing_joints": action.missing_joints,
        "activations": action.activations,
        "held": None,
        "frames": action.frames,
    }


def _hands(action: Action) -> tuple[Hand, ...]:
    """List the hands that may have acted: the one that was marked, the moving arm's, or both."""
    hand = action.hand or PART_HANDS.get(action.part)
    return ("right", "left") if hand is None else (hand,)


def _evidence(track: Track, actor: Actor, hands: Sequence[Hand]) -> Evidence:
    view, head = actor.view(track), actor.head()
    distances = {hand: proximity.smallest_distance(view, actor.hand(hand)) for hand in hands}
    angles = {hand: proximity.pointing_angle(view, actor.fingertip(hand), head) for hand in hands}
    near_hand, pointing_hand = min(hands, key=distances.__getitem__), min(hands, key=angles.__getitem__)
    return Evidence(track, distances[near_hand], near_hand, angles[pointing_hand], pointing_hand, track.shift())


def _acted_on(evidence: Sequence[Evidence], settings: Settings) -> Evidence | None:
    """Take the object with the smallest distance among those that were reached or moved; none: a pantomime."""
    candidates = [
        e
        for e in evidence
        if math.isfinite(e.distance_m)
        and (e.distance_m <= settings.reach_m or float(np.linalg.norm(e.shift)) >= settings.moved_m)
    ]
    return min(candidates, key=lambda e: e.distance_m, default=None)


def _pointed_at(evidence: Sequence[Evidence], settings: Settings) -> Evidence | None:
    """Take the object nearest to the ray from the head through the fingertip."""
    candidates = [e for e in evidence if math.degrees(e.angle) <= settings.pointing_limit_deg]
    return min(candidates, key=lambda e: e.angle, default=None)


def _motion(chosen: Evidence | None, postures: Sequence[PostureSample], settings: Settings) -> Motion | None:
    """Express the object's displacement in the level frame of the segment's first valid posture."""
    if chosen is None:
        return None
    first = next(sample.body for sample in postures if sample.body is not None)
    level_from_camera = displacement.level_from_camera(first.ego_from_camera, np.array(settings.up_in_camera))
    if level_from_camera is None:
        return None
    return Motion(displacement_m=(level_from_camera @ chosen.shift).tolist())


def _acted_object(chosen: Evidence | None) -> ActedObject | None:
    if chosen is None:
        return None
    return ActedObject(id=chosen.track.id, name=chosen.track.name, distance_m=chosen.distance_m)


def _hand_of(chosen: Evidence | None, pointing: bool, hands: tuple[Hand, ...]) -> Hand | None:
    """Name the hand that acted; None where both might have and no object tells which."""
    if len(hands) == 1:
        return hands[0]
    if chosen is None:
        return None
    return chosen.pointing_hand if pointing else chosen.near_hand


def _absence(distances: dict[str, float], pointing: bool) -> str | None:
    """Say why no object was chosen, where there were objects to choose from."""
    if not distances:
        return None
    return "no object along the arm" if pointing else "no object within reach"


def _sentence(action: Action, chosen: Evidence | None, result: str | None, absence: str | None) -> str:
    """Write e.g. `push object 3 "cup", 0.21 m away, 0.94`; what may be no such action is said to be unknown."""
    what = f"unknown, most like {action.action}" if action.unknown else str(action.action)
    if chosen is not None:
        what = f'{what} object {chosen.track.id} "{chosen.track.name}"'
    clauses = [what, result if chosen is not None else absence, f"{action.confidence:.2f}"]
    return ", ".join(clause for clause in clauses if clause)


def _gaps(postures: Sequence[PostureSample]) -> int:
    """Count the postures lost between those received, from their numbers; numbers that fall are a restart."""
    numbers = [sample.seq for sample in postures if sample.seq is not None]
    return sum(max(later - earlier - 1, 0) for earlier, later in pairwise(numbers))
