"""From an action, its agent's postures and the objects' sightings to one event."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from action_fusion import displacement, proximity
from action_fusion.buffers import LOOK_BACK_NS
from action_fusion.carrying import carried_tracks
from action_fusion.choosing import NO_HAND, Choice, choose, evidence
from action_fusion.ending import acted_object
from action_fusion.hands import HandPath, Hands, hand_path
from action_fusion.samples import ObjectsSample, PostureSample
from action_fusion.settings import Settings
from action_fusion.sightline import aligned, depth_std_m
from action_fusion.tracks import Track, tracks
from action_fusion.wording import sentence
from actum.messages import Action, Event, Hand, HeldObject, Motion
from actum.node import SECOND_NS

PART_HANDS: dict[str | None, Hand] = {"right_arm": "right", "left_arm": "left"}
FACING_NS = 2 * SECOND_NS
"""Where an actor faces is the mean over this long from the start: the hips of one posture are several degrees out."""

BOTH: tuple[Hand, Hand] = ("right", "left")


def fuse(
    action: Action,
    postures: Sequence[PostureSample],
    others: Sequence[Sequence[PostureSample]],
    frames: Sequence[ObjectsSample],
    settings: Settings,
) -> Event:
    """Tell what a recognised action was applied to, and what became of it.

    Args:
        action: a valid final action with label and end.
        postures: its agent's, from some time before the start up to the end.
        others: those of each of the other agents who are there, over the same time.
        frames: the objects', over the same time.
        settings: thresholds and labels.
    """
    hands = _hands(action)
    inside = [sample for sample in postures if sample.stamp_ns >= action.start_ns]
    strangers = [path for other in others for path in _paths(other, action.start_ns).values()]
    paths = Hands(_paths(postures, action.start_ns), strangers)
    seen = _tracks(action, frames, paths, depth_std_m(inside), settings)
    actor = proximity.actor(inside, action.start_ns)
    found = [] if actor is None else evidence(seen, actor, hands)
    choice = Choice(why=NO_HAND) if actor is None and seen else choose(action, found, paths, hands, settings)
    became = _became(action, choice, inside, settings)
    likely = [acted_object(e, choice, paths.own, frames, action.start_ns, settings) for e in choice.likely]
    return Event(
        **_common(action),
        **became,
        object=likely[0] if likely else None,
        held=None if choice.held is None else HeldObject(id=choice.held.id, name=choice.held.name),
        hand=hands[0] if len(hands) == 1 else choice.hand,
        objects_present=[track.id for track in seen],
        distances_m={str(e.track.id): e.distance_m for e in found if math.isfinite(e.distance_m)},
        candidates=[candidate for candidate in likely if candidate is not None] if choice.rivals else [],
        pointing=choice.pointing,
        why=choice.why,
        sentence=sentence(action, choice, became["result"]),
        missed=action.missed + _gaps(inside),
    )


def rejected(action: Action, reason: str) -> Event:
    """Pass a rejection on, with its reason."""
    return Event(
        **_common(action),
        valid=False,
        reason=reason,
        object=None,
        held=None,
        hand=action.hand,
        objects_present=[],
        distances_m={},
        motion=None,
        result=None,
        sentence=f"no recognition: {reason}",
        missed=action.missed,
    )


def _common(action: Action) -> dict[str, Any]:
    """Copy what an event takes over from its action."""
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
        "frames": action.frames,
    }


def _hands(action: Action) -> tuple[Hand, ...]:
    """List the hands that may have acted: the one that was marked, the moving arm's, or both."""
    hand = action.hand or PART_HANDS.get(action.part)
    return BOTH if hand is None else (hand,)


def _paths(postures: Sequence[PostureSample], start_ns: int) -> dict[Hand, HandPath]:
    """Follow the hands that are known, from before the segment on."""
    actor = proximity.actor(postures, start_ns)
    if actor is None:
        return {}
    paths = [hand_path(actor, hand) for hand in BOTH]
    return {path.hand: path for path in paths if len(path.stamps_ns)}


def _tracks(
    action: Action, frames: Sequence[ObjectsSample], paths: Hands, std_m: float, settings: Settings
) -> list[Track]:
    """Follow the objects; the paper's measure takes what was seen alone."""
    seen = [t for t in tracks(frames, action.start_ns) if t.stamps_ns[-1] >= -LOOK_BACK_NS]
    known = aligned(seen, paths.own.values(), std_m, settings)
    if settings.measure == "proximity" or action.end_ns is None:
        return [track.only(track.seen) for track in known if track.seen.any()]
    return carried_tracks(known, paths.everybodys, action.end_ns - action.start_ns, settings)


def _became(action: Action, choice: Choice, postures: Sequence[PostureSample], settings: Settings) -> dict[str, Any]:
    """Tell what became of the object, in the level frame of the actor as the segment starts."""
    nothing = {"motion": None, "result": None, "outcome": None, "agrees": None}
    if choice.evidence is None:
        return nothing
    known = [(sample.stamp_ns, sample.body) for sample in postures if sample.body is not None]
    first_ns, first = known[0]
    ahead = [body.ego_from_camera[2, :3] for stamp_ns, body in known if stamp_ns <= first_ns + FACING_NS]
    level_from_camera = displacement.level_from_camera(np.mean(ahead, axis=0), np.array(first.up_in_camera))
    if level_from_camera is None:
        return nothing
    shift = level_from_camera @ choice.evidence.track.shift()
    outcome = displacement.outcome(shift, settings.moved_m, first.faces)
    expected = settings.expected_outcomes.get(str(action.action))
    direction = displacement.direction(shift, settings.moved_m, first.faces)
    return {
        "motion": Motion(displacement_m=shift.tolist(), direction=direction),
        "result": displacement.result(shift, settings.moved_m, first.faces),
        "outcome": outcome,
        "agrees": displacement.agrees(outcome, expected),
    }


def _gaps(postures: Sequence[PostureSample]) -> int:
    """Count the postures lost between those received, from their numbers; numbers that fall are a restart."""
    numbers = [sample.seq for sample in postures if sample.seq is not None]
    return sum(max(later - earlier - 1, 0) for earlier, later in pairwise(numbers))
