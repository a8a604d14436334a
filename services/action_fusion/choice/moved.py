"""The object that a hand moved, with or without a tool, or that moved away from it."""

from collections.abc import Sequence

import numpy as np

from action_fusion.choice.evidence import Choice, Evidence, pairs_of
from action_fusion.settings import Settings
from action_fusion.tracks.comotion import STEADY_M, Comotion, comotion, transporting
from action_fusion.tracks.object_tracks import ObjectTrack
from actum.arrays import Mask, median

STEADY_SHARE = 0.75
"""Least share of the segment in which a held object has a constant offset from the hand, where neither moves."""

WORKING_M = 0.05
"""Largest deviation of a tool in use from one place: stirring, pouring and cutting move by the width of a hand."""

WORKING_SHARE = 0.75
"""Least share of the time in hand in which a tool is in use: it is also brought to the target and taken away."""


def held(evidence: Evidence) -> Choice | None:
    """Choose the object that a hand holds and transports or, if that is used as a tool, the object it is used on.

    An object held during an action with an expected outcome is no tool.
    """
    in_hand = [pair for pair in evidence.own if pair in evidence.transporting and _is_held(pair, evidence.settings)]
    best = max(in_hand, key=lambda pair: (pair.transport_m(0.0), pair.transport_m()), default=None)
    if best is None:
        return None
    target = None
    if evidence.action.action not in evidence.settings.expected_outcomes:
        left = [pair for pair in evidence.free if pair.hand is best.hand and pair not in evidence.transporting]
        target = _tool_target(best, left, evidence.settings)
    return Choice((target or best).track, (best.hand.side,), best.track)


def moved_at_hand(evidence: Evidence) -> Choice | None:
    """Choose the object that was displaced while a hand was near it, the nearest of several."""
    return _nearest([pair for pair in _displaced(evidence) if pair.in_motion_nearby])


def released(evidence: Evidence) -> Choice | None:
    """Choose the object that a hand held up to the segment's start and has just released, the last of several."""
    let_go = [pair for pair in evidence.own if pair in evidence.transporting]
    latest = max(let_go, key=lambda pair: float(pair.hand.stamps_ns[pair.with_hand].max()), default=None)
    return None if latest is None else Choice(latest.track, (latest.hand.side,))


def sent_away(evidence: Evidence) -> Choice | None:
    """Choose the object that was displaced further away from the hand: thrown, or pushed with a tool.

    The tool may have no marker: the object moves with the hand at a tool's distance.
    """
    reach_m, moved_m, sent = evidence.settings.reach_with_tool_m, evidence.settings.moved_m, []
    for pair in _displaced(evidence):
        thrown = (pair.near & pair.hand.recent).any()
        if thrown or comotion(pair.hand, pair.track, reach_m, moved_m).is_transported(moved_m):
            sent.append(pair)
    return _nearest(sent)


def displaced_by_others(evidence: Evidence) -> list[ObjectTrack]:
    """List the displaced objects that neither were in the actor's hands, nor moved near them in nobody's hand."""
    moved_m = evidence.settings.moved_m
    displaced = [one.track for one in evidence.near if one.track.is_displaced(moved_m)]
    pairs = pairs_of(displaced, evidence.hands.everyones, evidence.settings.reach_m, evidence.settings)
    in_hand = transporting(pairs, moved_m)
    transported = {pair.track.id for pair in in_hand}
    own = [pair for pair in pairs if pair.hand in evidence.hands.own.values()]
    near = {pair.track.id for pair in own if pair.in_motion_nearby and pair.track.id not in transported}
    by_actor = near | {pair.track.id for pair in own if pair in in_hand}
    return [track for track in displaced if track.id not in by_actor]


def _displaced(evidence: Evidence) -> list[Comotion]:
    return [pair for pair in evidence.free if pair.track.is_displaced(evidence.settings.moved_m)]


def _nearest(pairs: Sequence[Comotion]) -> Choice | None:
    nearest = min(pairs, key=lambda pair: float(pair.distances_m.min()), default=None)
    return None if nearest is None else Choice(nearest.track, (nearest.hand.side,))


def _is_held(pair: Comotion, settings: Settings) -> bool:
    """Whether the object is in the hand during the segment, not only before it."""
    if pair.transport_m(0.0) >= settings.moved_m:
        return True
    hand_to_object_m = pair.hand_to_object_m[pair.hand.in_segment]
    if not len(hand_to_object_m):
        return False
    slip = np.linalg.norm(hand_to_object_m - median(hand_to_object_m), axis=1)
    near = pair.distances_m[pair.hand.in_segment] <= settings.grasp_m
    return bool(np.mean((slip <= STEADY_M) & near) >= STEADY_SHARE)


def _tool_target(held: Comotion, others: Sequence[Comotion], settings: Settings) -> Comotion | None:
    """Find the object that the held object is used on, the nearest of several; None where there is none.

    A tool in use stays at one place relative to its target, instead of being transported past it. For at least three
    quarters of the time in hand, the held object stays within `WORKING_M` of its median position relative to the
    target, and no further from the target than `grasp_m`.
    """
    instants = _in_hand(held)
    if not instants.any():
        return None
    nearness: list[tuple[float, Comotion]] = []
    for other in others:
        between_m = (held.object_m - other.object_m)[instants]
        distances_m = np.linalg.norm(between_m, axis=1)
        deviations_m = np.linalg.norm(between_m - median(between_m), axis=1)
        if np.mean((deviations_m <= WORKING_M) & (distances_m <= settings.grasp_m)) >= WORKING_SHARE:
            nearness.append((float(median(distances_m)), other))
    return min(nearness, key=lambda near: near[0], default=(0.0, None))[1]


def _in_hand(held: Comotion) -> Mask:
    """Mask (n,) of the segment's instants at which the object is in the hand, since the hand first moved it."""
    moved = np.flatnonzero(held.with_hand)
    if not len(moved):
        return held.with_hand
    instants = np.arange(len(held.with_hand))
    near = held.distances_m <= median(held.distances_m[moved]) + WORKING_M
    in_hand: Mask = near & (instants >= moved[0]) & held.hand.in_segment
    return in_hand
