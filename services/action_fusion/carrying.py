"""Where an object is while a hand covers it: it goes with the hand that has grasped it, and stays until then."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from action_fusion.comotion import comotion
from action_fusion.hands import HandPath
from action_fusion.samples import Array
from action_fusion.settings import Settings
from action_fusion.stops import RESTING_M_PER_S
from action_fusion.tracks import SETTLED_NS, Track
from actum.node import SECOND_NS

SHORTEST_GAP_NS = SECOND_NS // 5
"""Shorter gaps are bridged by a straight line."""

TOUCHING_M = 0.02
"""A hand that is this close to its closest is there."""

SLIPS_M = 0.10
"""What a hand carries stays where it is in it, as far as a joint's noise lets one tell."""

Grasp = tuple[HandPath, int, int]
"""A hand, and the instants of it at which it takes and lets go of an object that is not seen in between."""


def carried_tracks(tracks: Sequence[Track], paths: Sequence[HandPath], end_ns: int, settings: Settings) -> list[Track]:
    """Let what is not seen move with the hand that has it, until it is seen again or the segment ends.

    Where what covers it is followed in the image it is there, and else where the hand's joint is. It is in a hand that
    came within grasp of where it was last seen: things do not move by themselves. Where it is seen again, it has moved
    and is within reach of that hand. Of several that are not seen again a hand has the nearest, and none if it moves
    one that is seen.
    """
    held = [held for track in tracks if len((held := _in_hand(track, paths, settings)).stamps_ns)]
    bridged = [_bridged(track, paths, settings) for track in held]
    lost = [(distance_m, grasp, t) for path in paths for distance_m, grasp, t in _lost(bridged, path, end_ns, settings)]
    nearest = {t.id: grasp for _, grasp, t in sorted(lost, key=lambda found: -found[0])}
    return [_following(t, nearest[t.id]) if t.id in nearest else t for t in bridged]


def _lost(tracks: Sequence[Track], path: HandPath, end_ns: int, settings: Settings) -> list[tuple[float, Grasp, Track]]:
    """Find the object that went out of sight in this hand: at most one."""
    found = [(*grasped, t) for t in tracks if (grasped := _lost_in(t, path, end_ns, settings)) is not None]
    if not found:
        return []
    pairs = [comotion(path, track, settings.reach_m, settings.moved_m) for track in tracks]
    seen_moving = [pair for pair in pairs if pair.moved_by_hand_m(since_ns=0.0) >= settings.moved_m]
    moved = [pair.track.id for pair in seen_moving if pair.is_carried(settings.moved_m)]
    candidates = [one for one in found if not moved or one[2].id in moved]
    return sorted(candidates, key=lambda one: one[0])[:1]


def _in_hand(track: Track, paths: Sequence[HandPath], settings: Settings) -> Track:
    """Leave out where an object was followed to though no hand had taken it, or had it still: something else did."""
    kept = track.seen.copy()
    for run in np.split(np.arange(len(kept)), np.flatnonzero(np.diff(kept)) + 1):
        if not track.seen[run[0]]:
            kept[run] = any(_has(path, track, max(int(run[0]) - 1, 0), int(run[-1]), settings) for path in paths)
    return track.only(kept)


def _has(path: HandPath, track: Track, first: int, last: int, settings: Settings) -> bool:
    """Tell whether a hand came within grasp of an object's first place, and has it where it had it at its last."""
    since_ns, until_ns = track.stamps_ns[[first, last]]
    inside = np.flatnonzero((path.stamps_ns >= since_ns) & (path.stamps_ns <= until_ns))
    if not len(inside):
        return False
    distances = np.linalg.norm(path.positions_m[inside] - track.positions_m[first], axis=1)
    held = inside[_first_closest(distances) :]
    stamps_ns = path.stamps_ns[held]
    to_hand = path.positions_m[held] - track.at(stamps_ns)
    early, late = (to_hand[np.abs(stamps_ns - end_ns) <= SETTLED_NS].mean(axis=0) for end_ns in stamps_ns[[0, -1]])
    return bool(distances.min() <= settings.grasp_m and np.linalg.norm(late - early) <= SLIPS_M)


def _bridged(track: Track, paths: Sequence[HandPath], settings: Settings) -> Track:
    """Fill the gaps between two sightings at which the object was in the same hand, at different places."""
    for i in np.flatnonzero(np.diff(track.stamps_ns) >= SHORTEST_GAP_NS)[::-1]:
        place, later = track.positions_m[i : i + 2]
        if np.linalg.norm(later - place) < settings.moved_m:
            continue
        grasps = [_grasp(track, int(i), path, float(track.stamps_ns[i + 1]), settings) for path in paths]
        found = min((g for g in grasps if g is not None), key=lambda g: g[0], default=None)
        if found is not None:
            track = _between(track, int(i), found[1])
    return track


def _lost_in(track: Track, path: HandPath, end_ns: int, settings: Settings) -> tuple[float, Grasp] | None:
    last = len(track.stamps_ns) - 1
    if end_ns - track.stamps_ns[last] < SHORTEST_GAP_NS:
        return None
    return _grasp(track, last, path, float(end_ns), settings)


def _grasp(
    track: Track, sighting: int, path: HandPath, until_ns: float, settings: Settings
) -> tuple[float, Grasp] | None:
    """Find when the hand takes the object after a sighting, and when it lets go of it before the next."""
    since_ns = track.stamps_ns[sighting]
    instants = np.flatnonzero((path.stamps_ns >= since_ns) & (path.stamps_ns <= until_ns))
    if not len(instants):
        return None
    distances = np.linalg.norm(path.positions_m[instants] - track.positions_m[sighting], axis=1)
    if distances.min() > settings.grasp_m:
        return None
    taken = int(instants[_first_closest(distances)])
    if sighting + 1 == len(track.stamps_ns):
        return float(distances.min()), (path, taken, int(instants[-1]))
    after = np.linalg.norm(path.positions_m[instants] - track.positions_m[sighting + 1], axis=1)
    left = int(instants[len(instants) - 1 - _first_closest(after[::-1])])
    return (float(distances.min()), (path, taken, left)) if after.min() <= settings.reach_m and taken < left else None


def _first_closest(distances: Array) -> int:
    return int(np.argmax(distances <= distances.min() + TOUCHING_M))


def _between(track: Track, sighting: int, grasp: Grasp) -> Track:
    """Carry the object from one sighting to the next; what its places in the hand differ by is spread over the way."""
    path, taken, left = grasp
    way = path.positions_m[taken : left + 1]
    start, end = track.positions_m[sighting] - way[0], track.positions_m[sighting + 1] - way[-1]
    share = np.linspace(0.0, 1.0, len(way))[:, None]
    return _inserted(track, sighting + 1, path.stamps_ns[taken : left + 1], way + (1 - share) * start + share * end)


def _following(track: Track, grasp: Grasp) -> Track:
    """Carry the object from its last sighting on, at the place in the hand at which it was taken."""
    path, taken, left = grasp
    way = path.positions_m[taken : left + 1]
    moving = np.flatnonzero(path.speeds()[taken : left + 1] > RESTING_M_PER_S)
    taking = way[: max(1, moving[0] if len(moving) else len(way))]
    in_hand = track.positions_m[-1] - taking.mean(axis=0)
    return _inserted(track, len(track.stamps_ns), path.stamps_ns[taken : left + 1], way + in_hand)


def _inserted(track: Track, index: int, stamps_ns: Array, positions_m: Array) -> Track:
    """Add places that were not seen; they stand between sightings, or after all."""
    inside = (stamps_ns > track.stamps_ns[index - 1]) & (
        stamps_ns < (track.stamps_ns[index] if index < len(track.stamps_ns) else np.inf)
    )
    return replace(
        track,
        stamps_ns=np.insert(track.stamps_ns, index, stamps_ns[inside]),
        positions_m=np.insert(track.positions_m, index, positions_m[inside], axis=0),
        seen=np.insert(track.seen, index, np.zeros(int(inside.sum()), dtype=bool)),
    )
