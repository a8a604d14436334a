"""Which object a hand acts on, decided over the whole segment from closeness and from moving together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.application import applied_to
from action_fusion.comotion import STEADY_M, Comotion, carriers, comotion
from action_fusion.contact import gives_way_m, misses_m
from action_fusion.hands import HandPath, Hands
from action_fusion.settings import Settings
from action_fusion.tracks import Track
from actum.messages import Hand

STEADY_SHARE = 0.75

MOST_OBJECTS = 32

Carriers = Mapping[int, Sequence[HandPath]]
"""The hands that carry each object, by its id."""

NUDGED_MORE = 3.0
"""One object was nudged and another was not where the first moved this many times as far."""


@dataclass(frozen=True)
class Decision:
    """The object acted on, by which hand, and what is in that hand; `rivals` are as likely as the object."""

    track: Track
    hand: Hand
    held: Track | None = None
    rivals: tuple[Track, ...] = ()


def decide(
    paths: Hands, tracks: Sequence[Track], hands: Sequence[Hand], applies: bool, settings: Settings
) -> Decision | None:
    """Decide what was acted on; None where nothing was: an empty reach, a pantomime.

    What a hand carries comes first, or what it works at with that if the action is such (`applies`); then what moved
    while the hand was at it, for things do not move by themselves; then what the hand reached for and left where it
    is, what it has just let go of, and last what moved away from it: thrown, or pushed with something. What moves
    where the hands never were is another's.

    Args:
        paths: both hands, and others' too, from some time before the segment to its end: what another moves is not
            this actor's.
        tracks: the objects over the same time.
        hands: those that may have acted.
        applies: whether a held object may be a tool.
        settings: thresholds.
    """
    concerned = _concerned(paths.own, tracks, settings)
    pairs = [
        comotion(path, track, settings.reach_m, settings.moved_m) for path in paths.everybodys for track in concerned
    ]
    carrier = carriers(pairs, settings.moved_m)
    acting = [paths.own[hand] for hand in hands if hand in paths.own]
    own = [pair for path in acting for pair in pairs if pair.path is path]
    held = [pair for pair in own if _carries(carrier, pair) and _is_kept(pair, settings)]
    if held:
        best = max(held, key=lambda pair: (pair.moved_by_hand_m(0.0), pair.moved_by_hand_m()))
        return _with_held(best, pairs, carrier, applies, settings)
    free = [pair for pair in own if pair.track.id not in carrier or _carries(carrier, pair)]
    displaced = [pair for pair in free if float(np.linalg.norm(pair.track.shift())) >= settings.moved_m]
    at_hand = [pair for pair in displaced if pair.moved_nearby]
    sent = [pair for pair in displaced if (pair.near & pair.recent).any() or _is_pushed_along(pair, settings)]
    return _nearest(at_hand) or _reached(acting, free, settings) or _released(own, carrier) or _nearest(sent)


def moved_by_others(paths: Hands, tracks: Sequence[Track], settings: Settings) -> list[Track]:
    """List what moved in the segment, not in the actor's hands nor, where no hand was seen to have it, near them."""
    moved = [track for track in tracks if float(np.linalg.norm(track.shift())) >= settings.moved_m]
    pairs = [comotion(path, track, settings.reach_m, settings.moved_m) for path in paths.everybodys for track in moved]
    carrier = carriers(pairs, settings.moved_m)
    own = [pair for pair in pairs if any(pair.path is path for path in paths.own.values())]
    near = {pair.track.id for pair in own if pair.moved_nearby and pair.track.id not in carrier}
    in_hand = {pair.track.id for pair in own if _carries(carrier, pair)}
    return [track for track in moved if track.id not in near | in_hand]


def _carries(carrier: Carriers, pair: Comotion) -> bool:
    return any(path is pair.path for path in carrier.get(pair.track.id, ()))


def _concerned(paths: Mapping[Hand, HandPath], tracks: Sequence[Track], settings: Settings) -> list[Track]:
    """Leave out what lay still beyond the reach of a held thing; of a crowd the nearest are left."""
    distances_m = [
        min(float(np.linalg.norm(track.at(path.stamps_ns) - path.positions_m, axis=1).min()) for path in paths.values())
        for track in tracks
    ]
    nearest = sorted(zip(distances_m, tracks, strict=True), key=lambda near: near[0])[:MOST_OBJECTS]
    return [t for d, t in nearest if d <= settings.reach_with_m or float(np.linalg.norm(t.shift())) >= settings.moved_m]


def _is_pushed_along(pair: Comotion, settings: Settings) -> bool:
    """Whether the object went as the hand did, as far from it as a thing in the hand reaches that may not be marked."""
    with_tool = comotion(pair.path, pair.track, settings.reach_with_m, settings.moved_m)
    return with_tool.is_carried(settings.moved_m)


def _is_kept(pair: Comotion, settings: Settings) -> bool:
    """Whether the object is in the hand during the segment, not only before it."""
    if pair.moved_by_hand_m(0.0) >= settings.moved_m:
        return True
    relative = pair.relative_m[pair.path.stamps_ns >= 0]
    if not len(relative):
        return False
    strayed = np.linalg.norm(relative - np.median(relative, axis=0), axis=1)
    near = np.linalg.norm(relative, axis=1) <= settings.grasp_m
    return bool(np.mean((strayed <= STEADY_M) & near) >= STEADY_SHARE)


def _with_held(
    held: Comotion, pairs: Sequence[Comotion], carrier: Carriers, applies: bool, settings: Settings
) -> Decision:
    others = [pair for pair in pairs if pair.path is held.path and pair.track.id not in carrier]
    patient = applied_to(held, others, settings) if applies else None
    return Decision(held.track if patient is None else patient.track, held.path.hand, held.track)


def _reached(paths: Sequence[HandPath], free: Sequence[Comotion], settings: Settings) -> Decision | None:
    """Take what a hand missed by least; of those that it missed by hardly more the one that gave way, if one did."""
    misses = [miss for path in paths for miss in _missed(path, [pair for pair in free if pair.path is path], settings)]
    if not misses:
        return None
    least = min(missed for _, missed in misses)
    close = sorted((m for m in misses if m[1] <= least + settings.uncertainty_m), key=lambda miss: miss[1])
    best = _gave_way([pair for pair, _ in close])
    rivals = {pair.track.id: pair.track for pair, _ in close if best is None and pair.track is not close[0][0].track}
    best = best or close[0][0]
    return Decision(best.track, best.path.hand, None, tuple(rivals.values()))


def _gave_way(pairs: Sequence[Comotion]) -> Comotion | None:
    """Find the one that was nudged clearly more than every other, if there is one."""
    nudges = sorted(((gives_way_m(pair), i) for i, pair in enumerate(pairs)), reverse=True)
    if nudges[0][0] == 0 or any(
        nudge * NUDGED_MORE > nudges[0][0] for nudge, i in nudges[1:] if pairs[i].track is not pairs[nudges[0][1]].track
    ):
        return None
    return pairs[nudges[0][1]]


def _missed(path: HandPath, own: Sequence[Comotion], settings: Settings) -> list[tuple[Comotion, float]]:
    misses = misses_m(path, own, settings)
    return [(pair, misses[pair.track.id]) for pair in own if pair.track.id in misses]


def _released(own: Sequence[Comotion], carrier: Carriers) -> Decision | None:
    """Take what a hand has just let go of."""
    released = [pair for pair in own if _carries(carrier, pair)]
    latest = max(released, key=lambda pair: float(pair.path.stamps_ns[pair.with_hand].max()), default=None)
    return None if latest is None else Decision(latest.track, latest.path.hand)


def _nearest(pairs: Sequence[Comotion]) -> Decision | None:
    nearest = min(pairs, key=lambda pair: float(pair.distances_m.min()), default=None)
    return None if nearest is None else Decision(nearest.track, nearest.path.hand)
