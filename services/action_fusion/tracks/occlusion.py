"""Positions of occluded objects: an object moves with the hand that has grasped it, and else stays in place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from action_fusion.settings import Settings
from action_fusion.tracks.comotion import comotion
from action_fusion.tracks.hand_tracks import RESTING_M_PER_S, SAME_PLACE_M, HandTrack, stops
from action_fusion.tracks.object_tracks import SETTLED_NS, ObjectTrack
from actum.arrays import Array
from actum.node import SECOND_NS

SHORTEST_GAP_NS = SECOND_NS // 5
"""Shorter gaps between sightings are interpolated linearly."""

TOUCHING_M = 0.02
"""Excess over a hand's smallest distance up to which the hand has arrived: about a joint's noise."""

SLIP_M = 0.10
"""Largest change of a held object's offset from the hand: a joint's noise."""


@dataclass(frozen=True)
class Grasp:
    """A hand holds an occluded object from the instant `taken` of the hand's track to the instant `released`.

    `distance_m` is the hand's smallest distance from the object's last sighting before the grasp.
    """

    hand: HandTrack
    taken: int
    released: int
    distance_m: float

    @property
    def stamps_ns(self) -> Array:
        """Stamps (g,) of the g instants of the grasp."""
        return self.hand.stamps_ns[self.taken : self.released + 1]

    @property
    def hand_m(self) -> Array:
        """The hand's positions (g, 3) during the grasp, camera frame."""
        return self.hand.positions_m[self.taken : self.released + 1]


def fill_occlusions(
    tracks: Sequence[ObjectTrack], hands: Sequence[HandTrack], end_ns: int, settings: Settings
) -> list[ObjectTrack]:
    """Move each occluded object with the hand that holds it, until its next sighting or the segment's end.

    The object's positions are the image-tracked ones, or else those of the hand's joint. A hand can hold an object only
    if it came within grasp of the object's last sighting. If there is a next sighting, it must be displaced and within
    reach of that hand. Of several objects without a next sighting, a hand holds the nearest, and none if it transports
    a visible object.
    """
    grasped = [_keep_grasped(track, hands, settings) for track in tracks]
    bridged = [_bridge_gaps(track, hands, settings) for track in grasped if len(track.stamps_ns)]
    unseen = [track for track in bridged if end_ns - track.stamps_ns[-1] >= SHORTEST_GAP_NS]
    found = [_lost_in_hand(unseen, bridged, hand, end_ns, settings) for hand in hands if unseen]
    lost = [pair for pair in found if pair is not None]
    grasps = {track.id: grasp for grasp, track in sorted(lost, key=lambda pair: -pair[0].distance_m)}
    return [_extrapolated(track, grasps[track.id]) if track.id in grasps else track for track in bridged]


def _keep_grasped(track: ObjectTrack, hands: Sequence[HandTrack], settings: Settings) -> ObjectTrack:
    """Drop image-tracked positions that no grasping hand explains."""
    if track.seen.all():
        return track
    kept = track.seen.copy()
    for run in np.split(np.arange(len(kept)), np.flatnonzero(np.diff(kept)) + 1):
        if not track.seen[run[0]]:
            first, last = max(int(run[0]) - 1, 0), int(run[-1])
            kept[run] = any(_holds(hand, track, first, last, settings) for hand in hands)
    return replace(track, stamps_ns=track.stamps_ns[kept], positions_m=track.positions_m[kept], seen=track.seen[kept])


def _holds(hand: HandTrack, track: ObjectTrack, first: int, last: int, settings: Settings) -> bool:
    """Whether a hand came within grasp of position `first`, and kept its offset from the object until `last`."""
    since_ns, until_ns = track.stamps_ns[[first, last]]
    inside = np.flatnonzero((hand.stamps_ns >= since_ns) & (hand.stamps_ns <= until_ns))
    if not len(inside):
        return False
    distances = np.linalg.norm(hand.positions_m[inside] - track.positions_m[first], axis=1)
    held = inside[_first_closest(distances) :]
    stamps_ns = hand.stamps_ns[held]
    to_hand = hand.positions_m[held] - track.at(stamps_ns)
    early, late = (to_hand[np.abs(stamps_ns - at_ns) <= SETTLED_NS].mean(axis=0) for at_ns in stamps_ns[[0, -1]])
    return bool(distances.min() <= settings.grasp_m and np.linalg.norm(late - early) <= SLIP_M)


def _bridge_gaps(track: ObjectTrack, hands: Sequence[HandTrack], settings: Settings) -> ObjectTrack:
    """Fill each gap between sightings at different positions with the object's positions in the hand that held it."""
    for i in (track.stamps_ns[1:] - track.stamps_ns[:-1] >= SHORTEST_GAP_NS).nonzero()[0][::-1]:
        before_m, after_m = track.positions_m[i : i + 2]
        if np.linalg.norm(after_m - before_m) < settings.moved_m:
            continue
        grasps = [_grasp(track, int(i), hand, float(track.stamps_ns[i + 1]), settings) for hand in hands]
        nearest = min((g for g in grasps if g is not None), key=lambda g: g.distance_m, default=None)
        if nearest is not None:
            track = _interpolated(track, int(i), nearest)
    return track


def _lost_in_hand(
    unseen: Sequence[ObjectTrack], tracks: Sequence[ObjectTrack], hand: HandTrack, end_ns: int, settings: Settings
) -> tuple[Grasp, ObjectTrack] | None:
    """Find the object that this hand has grasped and that is not seen any more, the nearest of several."""
    grasps = [(_grasp(track, len(track.stamps_ns) - 1, hand, float(end_ns), settings), track) for track in unseen]
    lost = [(_left_behind(grasp, track, settings), track) for grasp, track in grasps if grasp is not None]
    if not lost:
        return None
    pairs = [comotion(hand, track, settings.reach_m, settings.moved_m) for track in tracks]
    in_hand = [pair for pair in pairs if pair.transport_m(since_ns=0.0) >= settings.moved_m]
    transported = {pair.track.id for pair in in_hand if pair.is_transported(settings.moved_m)}
    candidates = [(grasp, track) for grasp, track in lost if not transported or track.id in transported]
    return min(candidates, key=lambda candidate: candidate[0].distance_m, default=None)


def _left_behind(grasp: Grasp, track: ObjectTrack, settings: Settings) -> Grasp:
    """Release a displaced object at the last stop of a hand that rests again where it was at the segment's start.

    An object that was not displaced up to that stop may have been brought along.
    """
    stopped = stops(grasp.hand)
    released = int(np.flatnonzero(stopped.last)[-1]) if stopped.returned else grasp.taken
    moved_m = np.linalg.norm(grasp.hand.positions_m[released] - grasp.hand.positions_m[grasp.taken])
    displaced = moved_m > SAME_PLACE_M or track.is_displaced(settings.moved_m)
    return replace(grasp, released=released) if released > grasp.taken and displaced else grasp


def _grasp(track: ObjectTrack, sighting: int, hand: HandTrack, until_ns: float, settings: Settings) -> Grasp | None:
    """Find when the hand grasps the object after a sighting and releases it before the next; None where it does not."""
    since_ns = track.stamps_ns[sighting]
    instants = np.flatnonzero((hand.stamps_ns >= since_ns) & (hand.stamps_ns <= until_ns))
    if not len(instants):
        return None
    distances = np.linalg.norm(hand.positions_m[instants] - track.positions_m[sighting], axis=1)
    nearest_m = float(distances.min())
    if nearest_m > settings.grasp_m:
        return None
    taken = int(instants[_first_closest(distances)])
    if sighting + 1 == len(track.stamps_ns):
        return Grasp(hand, taken, int(instants[-1]), nearest_m)
    after = np.linalg.norm(hand.positions_m[instants] - track.positions_m[sighting + 1], axis=1)
    released = int(instants[len(instants) - 1 - _first_closest(after[::-1])])
    if after.min() > settings.reach_m or taken >= released:
        return None
    return Grasp(hand, taken, released, nearest_m)


def _first_closest(distances_m: Array) -> int:
    """Find the index of the first of the distances (n,) that exceeds the smallest by at most `TOUCHING_M`."""
    return int(np.argmax(distances_m <= distances_m.min() + TOUCHING_M))


def _interpolated(track: ObjectTrack, sighting: int, grasp: Grasp) -> ObjectTrack:
    """Move the object with the hand between two sightings; its offset from the hand changes linearly in between."""
    hand_m = grasp.hand_m
    start_m, end_m = track.positions_m[sighting] - hand_m[0], track.positions_m[sighting + 1] - hand_m[-1]
    share = np.linspace(0.0, 1.0, len(hand_m))[:, None]
    return _inserted(track, sighting + 1, grasp.stamps_ns, hand_m + (1 - share) * start_m + share * end_m)


def _extrapolated(track: ObjectTrack, grasp: Grasp) -> ObjectTrack:
    """Move the object with the hand after its last sighting, at the offset from the hand at which it was grasped."""
    hand_m = grasp.hand_m
    moving = np.flatnonzero(grasp.hand.speeds_m_per_s()[grasp.taken : grasp.released + 1] > RESTING_M_PER_S)
    at_rest_m = hand_m[: max(1, moving[0] if len(moving) else len(hand_m))]
    in_hand_m = track.positions_m[-1] - at_rest_m.mean(axis=0)
    return _inserted(track, len(track.stamps_ns), grasp.stamps_ns, hand_m + in_hand_m)


def _inserted(track: ObjectTrack, index: int, stamps_ns: Array, positions_m: Array) -> ObjectTrack:
    """Insert positions (g, 3) without sighting, at stamps (g,), before the position `index` or at the end."""
    inside = (stamps_ns > track.stamps_ns[index - 1]) & (
        stamps_ns < (track.stamps_ns[index] if index < len(track.stamps_ns) else np.inf)
    )
    return replace(
        track,
        stamps_ns=np.insert(track.stamps_ns, index, stamps_ns[inside]),
        positions_m=np.insert(track.positions_m, index, positions_m[inside], axis=0),
        seen=np.insert(track.seen, index, np.zeros(int(inside.sum()), dtype=bool)),
    )
