"""The object that a hand interacts with, decided over the whole segment from distance and co-motion."""

from collections.abc import Sequence

import numpy as np

from action_fusion.choice import Choice
from action_fusion.comotion import STEADY_M, Comotion, TransportingHands, comotion, transporting_hands
from action_fusion.hand_tracks import HandTrack, HandTracks
from action_fusion.object_tracks import ObjectTrack
from action_fusion.reaching import misses_m, nudge_m
from action_fusion.settings import Settings
from action_fusion.tool_use import tool_target
from actum.messages import Hand

STEADY_SHARE = 0.75
"""Least share of the segment in which a held object has a constant offset from the hand, where neither moves."""

MOST_OBJECTS = 32
"""Most objects that are compared with each hand, the nearest ones: bounds the computing time."""

NUDGED_MORE = 3.0
"""An object counts as nudged if it moved this many times as far as every other one."""


def interacted_with(
    tracks: Sequence[ObjectTrack], hands: HandTracks, sides: Sequence[Hand], may_use_tool: bool, settings: Settings
) -> Choice | None:
    """Choose the object acted on; None where there is none, as in an empty reach or a pantomime.

    The first of these that exists is chosen:

    - the object that a hand holds and transports or, if that is used as a tool, the object it is used on;
    - an object displaced while a hand was near it;
    - an object that a hand reached for and left in place;
    - the object that a hand has just released;
    - an object displaced further away from the hand: thrown, or pushed with a tool.

    An object displaced where the actor's hands never were was moved by another person.

    Args:
        tracks: the objects, from some time before the segment to its end.
        hands: all hands over the same time; objects that another person's hands transport are left out.
        sides: the actor's hands that may have acted.
        may_use_tool: whether a held object may be a tool.
        settings: thresholds.
    """
    concerned = _concerned(tracks, list(hands.own.values()), settings)
    pairs = _pairs(concerned, hands, settings)
    transporting = transporting_hands(pairs, settings.moved_m)
    acting = [hands.own[side] for side in sides if side in hands.own]
    own = [pair for hand in acting for pair in pairs if pair.hand is hand]
    held = [pair for pair in own if _transports(transporting, pair) and _is_held(pair, settings)]
    if held:
        best = max(held, key=lambda pair: (pair.transport_m(0.0), pair.transport_m()))
        return _with_held(best, pairs, transporting, may_use_tool, settings)
    free = [pair for pair in own if pair.track.id not in transporting or _transports(transporting, pair)]
    displaced = [pair for pair in free if pair.track.is_displaced(settings.moved_m)]
    at_hand = [pair for pair in displaced if pair.in_motion_nearby]
    sent = [pair for pair in displaced if (pair.near & pair.recent).any() or _is_pushed_with_tool(pair, settings)]
    return _nearest(at_hand) or _reached(acting, free, settings) or _released(own, transporting) or _nearest(sent)


def displaced_by_others(tracks: Sequence[ObjectTrack], hands: HandTracks, settings: Settings) -> list[ObjectTrack]:
    """List the displaced objects that neither were in the actor's hands, nor moved near them in nobody's hand."""
    displaced = [track for track in tracks if track.is_displaced(settings.moved_m)]
    pairs = _pairs(displaced, hands, settings)
    transporting = transporting_hands(pairs, settings.moved_m)
    own = [pair for pair in pairs if any(pair.hand is hand for hand in hands.own.values())]
    near = {pair.track.id for pair in own if pair.in_motion_nearby and pair.track.id not in transporting}
    in_hand = {pair.track.id for pair in own if _transports(transporting, pair)}
    return [track for track in displaced if track.id not in near | in_hand]


def _pairs(tracks: Sequence[ObjectTrack], hands: HandTracks, settings: Settings) -> list[Comotion]:
    return [comotion(hand, track, settings.reach_m, settings.moved_m) for hand in hands.everyones for track in tracks]


def _transports(transporting: TransportingHands, pair: Comotion) -> bool:
    return any(hand is pair.hand for hand in transporting.get(pair.track.id, ()))


def _concerned(tracks: Sequence[ObjectTrack], own: Sequence[HandTrack], settings: Settings) -> list[ObjectTrack]:
    """Drop objects that stayed in place beyond the reach of a held tool; keep at most the nearest `MOST_OBJECTS`."""
    distances_m = [
        min(float(np.linalg.norm(track.at(hand.stamps_ns) - hand.positions_m, axis=1).min()) for hand in own)
        for track in tracks
    ]
    nearest = sorted(zip(distances_m, tracks, strict=True), key=lambda near: near[0])[:MOST_OBJECTS]
    return [
        track
        for distance_m, track in nearest
        if distance_m <= settings.reach_with_tool_m or track.is_displaced(settings.moved_m)
    ]


def _is_pushed_with_tool(pair: Comotion, settings: Settings) -> bool:
    """Whether the object moved with the hand at a tool's distance; the tool may have no marker."""
    with_tool = comotion(pair.hand, pair.track, settings.reach_with_tool_m, settings.moved_m)
    return with_tool.is_transported(settings.moved_m)


def _is_held(pair: Comotion, settings: Settings) -> bool:
    """Whether the object is in the hand during the segment, not only before it."""
    if pair.transport_m(0.0) >= settings.moved_m:
        return True
    hand_to_object_m = pair.hand_to_object_m[pair.hand.in_segment]
    if not len(hand_to_object_m):
        return False
    slip = np.linalg.norm(hand_to_object_m - np.median(hand_to_object_m, axis=0), axis=1)
    near = np.linalg.norm(hand_to_object_m, axis=1) <= settings.grasp_m
    return bool(np.mean((slip <= STEADY_M) & near) >= STEADY_SHARE)


def _with_held(
    held: Comotion, pairs: Sequence[Comotion], transporting: TransportingHands, may_use_tool: bool, settings: Settings
) -> Choice:
    others = [pair for pair in pairs if pair.hand is held.hand and pair.track.id not in transporting]
    target = tool_target(held, others, settings) if may_use_tool else None
    return Choice(held.track if target is None else target.track, held.hand.side, held.track)


def _reached(hands: Sequence[HandTrack], free: Sequence[Comotion], settings: Settings) -> Choice | None:
    """Choose the object with the smallest miss of a hand; among nearly equal misses, an object that was nudged."""
    misses = [miss for hand in hands for miss in _missed(hand, free, settings)]
    if not misses:
        return None
    least_m = min(missed_m for _, missed_m in misses)
    close = sorted((m for m in misses if m[1] <= least_m + settings.uncertainty_m), key=lambda miss: miss[1])
    nudged = _nudged([pair for pair, _ in close])
    best = nudged or close[0][0]
    rivals = {pair.track.id: pair.track for pair, _ in close if nudged is None and pair.track is not best.track}
    return Choice(best.track, best.hand.side, None, tuple(rivals.values()))


def _missed(hand: HandTrack, free: Sequence[Comotion], settings: Settings) -> list[tuple[Comotion, float]]:
    """Return the objects that the hand may have reached, each with the distance by which the hand missed it."""
    own = [pair for pair in free if pair.hand is hand]
    misses = misses_m(hand, own, settings)
    return [(pair, misses[pair.track.id]) for pair in own if pair.track.id in misses]


def _nudged(pairs: Sequence[Comotion]) -> Comotion | None:
    """Find the object that was nudged clearly further than every other one; None where there is none."""
    nudges = sorted(((nudge_m(pair), i) for i, pair in enumerate(pairs)), reverse=True)
    most_m, best = nudges[0][0], pairs[nudges[0][1]]
    others = [nudged_m for nudged_m, i in nudges[1:] if pairs[i].track is not best.track]
    return None if most_m == 0 or any(other_m * NUDGED_MORE > most_m for other_m in others) else best


def _released(own: Sequence[Comotion], transporting: TransportingHands) -> Choice | None:
    """Choose the object that a hand released last."""
    released = [pair for pair in own if _transports(transporting, pair)]
    latest = max(released, key=lambda pair: float(pair.hand.stamps_ns[pair.with_hand].max()), default=None)
    return None if latest is None else Choice(latest.track, latest.hand.side)


def _nearest(pairs: Sequence[Comotion]) -> Choice | None:
    nearest = min(pairs, key=lambda pair: float(pair.distances_m.min()), default=None)
    return None if nearest is None else Choice(nearest.track, nearest.hand.side)
