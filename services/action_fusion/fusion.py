"""Fuse an action, its actor's postures and the objects' positions to one event."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from action_fusion.acted_object import acted_object
from action_fusion.actors import Actor, acting_sides, actor_of
from action_fusion.buffers import LOOK_BACK_NS
from action_fusion.choice import Choice
from action_fusion.choosing import choose
from action_fusion.depth_alignment import aligned_in_depth
from action_fusion.displacement import described
from action_fusion.hand_tracks import HandTracks, hand_tracks
from action_fusion.object_tracks import ObjectTrack, object_tracks
from action_fusion.occlusion import fill_occlusions
from action_fusion.proximity import proximities
from action_fusion.sentence import sentence
from action_fusion.settings import Settings
from action_fusion.stream_samples import ObjectsSample, PostureSample
from actum.messages import Action, Event, HeldObject


def fuse(
    action: Action,
    postures: Sequence[PostureSample],
    others: Sequence[Sequence[PostureSample]],
    frames: Sequence[ObjectsSample],
    settings: Settings,
) -> Event:
    """Build the event of a recognised action: the object it was applied to, and the outcome for that object.

    Args:
        action: a valid final action with label and end.
        postures: the acting agent's samples, from some time before the segment's start up to its end.
        others: the posture samples of each other agent in the image, over the same time.
        frames: the samples of objects, over the same time.
        settings: thresholds and labels.
    """
    start_ns, sides = action.start_ns, acting_sides(action)
    actor = actor_of(postures, start_ns)
    acting = actor.in_segment()
    hands = hand_tracks(actor, [actor_of(other, start_ns) for other in others])
    tracks = _tracks(action, frames, hands, acting.median_depth_std_m(), settings)
    measured = proximities(acting, tracks, sides)
    choice = choose(action, measured, acting, hands, sides, settings)
    distances_m = {one.track.id: one.distance_m for one in measured if np.isfinite(one.distance_m)}
    likely = [acted_object(t, distances_m[t.id], choice, hands.own, frames, start_ns, settings) for t in choice.likely]
    outcome = _outcome(action, choice, acting, settings)
    return Event(
        **_common(action),
        **outcome,
        object=likely[0] if likely else None,
        held=None if choice.held is None else HeldObject(id=choice.held.id, name=choice.held.name),
        hand=sides[0] if len(sides) == 1 else choice.hand,
        objects_present=[track.id for track in tracks],
        distances_m={str(number): distance_m for number, distance_m in distances_m.items()},
        candidates=likely if choice.rivals else [],
        pointing=choice.pointing,
        why=choice.why,
        sentence=sentence(action, choice, outcome["result"]),
        missed=action.missed + _lost([sample for sample in postures if sample.stamp_ns >= start_ns]),
    )


def rejected(action: Action, reason: str) -> Event:
    """Build the invalid event of a rejected action, with the reason."""
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
        sentence=f"no recognition: {reason}" if action.action is None else f"no event of {action.action}: {reason}",
        missed=action.missed,
    )


def _common(action: Action) -> dict[str, Any]:
    """Return the fields that an event copies from its action."""
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
        "session_id": action.session_id,
    }


def _tracks(
    action: Action, frames: Sequence[ObjectsSample], hands: HandTracks, depth_std_m: float, settings: Settings
) -> list[ObjectTrack]:
    """Track the objects present in the segment and fill occlusions; the paper's measure uses sightings only."""
    present = [t for t in object_tracks(frames, action.start_ns) if t.stamps_ns[-1] >= -LOOK_BACK_NS]
    tracks = aligned_in_depth(present, hands.own.values(), depth_std_m, settings)
    if settings.measure == "proximity" or action.end_ns is None:
        return [track.keeping(track.seen) for track in tracks if track.seen.any()]
    return fill_occlusions(tracks, hands.everyones, action.end_ns - action.start_ns, settings)


def _outcome(action: Action, choice: Choice, actor: Actor, settings: Settings) -> dict[str, Any]:
    """Return the event's fields of motion and outcome, in the actor's level frame at the segment's start.

    They are those of the object's turn where it came back within the segment.
    """
    level_from_camera = None if choice.track is None else actor.level_from_camera()
    if choice.track is None or level_from_camera is None:
        return {"motion": None, "result": None, "outcome": None, "agrees": None}
    displacement_m = level_from_camera @ choice.track.displacement_m(settings.moved_m)
    turn = choice.track.turn(settings.moved_m)
    turn_ns = None if turn is None else action.start_ns + int(choice.track.stamps_ns[turn])
    expected = settings.expected_outcomes.get(str(action.action))
    return described(displacement_m, settings.moved_m, bool(actor.has_front[0]), expected, turn_ns)


def _lost(postures: Sequence[PostureSample]) -> int:
    """Count the postures lost between the received ones, by gaps in their sequence numbers; a fall is a restart."""
    numbers = [sample.seq for sample in postures if sample.seq is not None]
    return sum(max(later - earlier - 1, 0) for earlier, later in pairwise(numbers))
