"""Fuse an action, its actor's postures and the objects' positions to one event."""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from itertools import pairwise
from operator import attrgetter
from typing import Any

import numpy as np

from action_fusion.choice.cues import choose
from action_fusion.choice.evidence import NO_HAND, NO_OBJECT, Choice, gather
from action_fusion.intake.buffers import LOOK_BACK_NS, Hands, Sightings
from action_fusion.intake.stream_samples import ObjectsSample, PostureSample
from action_fusion.outcome.acted_object import acted_object
from action_fusion.outcome.displacement import described
from action_fusion.settings import Settings
from action_fusion.tracks.actors import Actor, actor_of
from action_fusion.tracks.depth_alignment import aligned_in_depth
from action_fusion.tracks.hand_tracks import HandTracks, hand_tracks
from action_fusion.tracks.object_tracks import ObjectTrack, object_tracks
from action_fusion.tracks.occlusion import fill_occlusions
from actum.arrays import median
from actum.messages import Action, Event, HeldObject

COPIED = (
    "stamp_ns", "sensor", "agent", "segment_id", "start_ns", "action", "confidence", "familiarity", "unknown",
    "missing_joints", "activations", "frames", "session_id",
)  # fmt: skip
"""The fields that an event copies from its action."""


def fuse(
    action: Action,
    postures: Sequence[PostureSample],
    hands: Sequence[Hands],
    sightings: Mapping[int, Sightings],
    frames: Sequence[ObjectsSample],
    settings: Settings,
) -> Event:
    """Build the event of a recognised action: the object it was applied to, and the outcome for that object.

    Args:
        action: a valid final action with label and end.
        postures: the acting agent's samples, from some time before the segment's start up to its end.
        hands: those of this agent, then of each other one in the image, over the same time.
        sightings: where each object was, by its number, over the same time.
        frames: the samples of objects, over the same time.
        settings: thresholds and labels.
    """
    start_ns = action.start_ns
    acting = postures[bisect_left(postures, start_ns, key=attrgetter("stamp_ns")) :]
    tracked = hand_tracks(hands[0], hands[1:])
    actor = actor_of(acting, start_ns)
    objects = object_tracks(sightings, frames)
    evidence = gather(action, actor, tracked, _tracks(action, objects, tracked, actor, settings), settings)
    choice = choose(evidence)
    likely = [acted_object(track, choice, evidence, frames) for track in choice.likely]
    described_outcome = described(choice.track, evidence)
    hands_named = evidence.sides if len(evidence.sides) == 1 and len(choice.hands) < 2 else choice.hands
    return Event(
        **_common(action),
        **described_outcome,
        object=likely[0] if likely else None,
        held=None if choice.held is None else HeldObject(id=choice.held.id, name=choice.held.name),
        hand=hands_named[0] if len(hands_named) == 1 else None,
        objects_present=[track.id for track in evidence.tracks],
        distances_m={str(one.track.id): one.distance_m for one in evidence.near},
        candidates=likely if choice.rivals else [],
        pointing=choice.pointing,
        why=choice.why,
        sentence=_sentence(action, choice, described_outcome["result"]),
        missed=action.missed + _lost(acting),
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


def _tracks(
    action: Action, objects: Sequence[ObjectTrack], hands: HandTracks, actor: Actor, settings: Settings
) -> list[ObjectTrack]:
    """Fill occlusions of the objects present in the segment; the paper's measure uses sightings only."""
    assert action.end_ns is not None
    present = [track for track in objects if track.stamps_ns[-1] >= -LOOK_BACK_NS]
    depth_std_m = float(median(np.array([body.depth_std_m for body in actor.bodies]))) if actor.bodies else 0.0
    tracks = aligned_in_depth(present, hands.own.values(), depth_std_m, settings)
    occluding = [] if settings.measure == "proximity" else hands.everyones
    return fill_occlusions(tracks, occluding, action.end_ns - action.start_ns, settings)


def _common(action: Action) -> dict[str, Any]:
    """Return the fields `COPIED` and the end, which is the start for an action without one."""
    copied = {name: getattr(action, name) for name in COPIED}
    return copied | {"end_ns": action.start_ns if action.end_ns is None else action.end_ns}


def _sentence(action: Action, choice: Choice, result: str | None) -> str:
    """Compose the sentence of an event, e.g. `push object 3 "cup", 0.21 m away, 0.94`.

    The reason why no object was chosen takes the result's place, if an object was in sight and a hand known.
    """
    what = f"unknown, most like {action.action}" if action.unknown else str(action.action)
    objects = " or ".join(track.label for track in choice.likely)
    tool = "" if choice.held is None or choice.held is choice.track else f"with {choice.held.label}"
    done = " ".join(part for part in (what, objects, tool) if part)
    why = None if choice.why in (NO_HAND, NO_OBJECT) else choice.why
    return ", ".join(clause for clause in (done, result or why, f"{action.confidence:.2f}") if clause)


def _lost(postures: Sequence[PostureSample]) -> int:
    """Count the postures lost between the received ones, by gaps in their sequence numbers; a fall is a restart."""
    numbers = [sample.seq for sample in postures if sample.seq is not None]
    return sum(max(later - earlier - 1, 0) for earlier, later in pairwise(numbers))
