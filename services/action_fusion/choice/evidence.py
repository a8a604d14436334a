"""What cues judge, the evidence of a segment, and what they answer: a choice."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from action_fusion.settings import Settings
from action_fusion.tracks.actors import Actor
from action_fusion.tracks.comotion import Comotion, comotion, gaps_m, transporting
from action_fusion.tracks.hand_tracks import BOTH_HANDS, HandTrack, HandTracks
from action_fusion.tracks.object_tracks import ObjectTrack
from actum.arrays import Array, stacked
from actum.messages import Action, Hand, Pointing

PART_HANDS: Mapping[str | None, Hand] = {"right_arm": "right", "left_arm": "left"}
"""Hand of each arm, by the name of the body part that moved most."""

NO_HAND = "the hand is not known"
NO_OBJECT = "no object in sight"
OUT_OF_REACH = "no object within reach"
LEFT_ALONE = "no object within reach was acted on"
OFF_THE_LINE = "no object along the arm"

MOST_OBJECTS = 32
"""Most objects that are compared with each hand, the nearest ones: bounds the computing time."""


BEYOND_M = 0.15
"""How much further from a hand than a held tool reaches an object is looked at: no cue looks as far."""


@dataclass(frozen=True)
class Choice:
    """The object acted on (`track`), or `why` there is none.

    `hands` are the hands that acted, one or both; `held` is the object in them. `rivals` are objects about as likely
    as `track`. `pointing` tells how well the arm points at `track`.
    """

    track: ObjectTrack | None = None
    hands: tuple[Hand, ...] = ()
    held: ObjectTrack | None = None
    rivals: tuple[ObjectTrack, ...] = ()
    pointing: Pointing | None = None
    why: str | None = None

    @property
    def likely(self) -> tuple[ObjectTrack, ...]:
        """The object and its rivals, the likeliest first."""
        return () if self.track is None else (self.track, *self.rivals)


@dataclass(frozen=True)
class Proximity:
    """The smallest distance of a hand to an object, and the hand that came nearest."""

    track: ObjectTrack
    distance_m: float
    hand: Hand


@dataclass(frozen=True)
class Evidence:
    """All that is known of an action's segment, and how hands and objects moved relative to each other in it.

    Attributes:
        action: the recognised action.
        sides: the actor's hands that may have acted.
        actor: the actor's postures in the segment itself.
        hands: the tracks of all hands, from some time before the segment to its end.
        tracks: those of the objects, over the same time.
        objects_ego: where the objects were at the actor's p postures, egocentric, (objects, p, 3).
        near: the objects with the hand that came nearest to each; none where no hand is known.
        settings: thresholds and labels.
    """

    action: Action
    sides: tuple[Hand, ...]
    actor: Actor
    hands: HandTracks
    tracks: Sequence[ObjectTrack]
    objects_ego: Array
    near: Sequence[Proximity]
    settings: Settings

    @cached_property
    def pairs(self) -> Sequence[Comotion]:
        """The pairs of everyone's hands with the objects that may concern the actor."""
        return _concerned([one.track for one in self.near], self.hands, self.settings)

    @cached_property
    def transporting(self) -> frozenset[Comotion]:
        """The pairs of anybody's hand and an object that this hand transports."""
        return transporting(self.pairs, self.settings.moved_m)

    @cached_property
    def own(self) -> Sequence[Comotion]:
        """The pairs of the hands that may have acted: those of one hand, then those of the other."""
        return [pair for side in self.sides for pair in self.pairs if pair.hand is self.hands.own.get(side)]

    @cached_property
    def free(self) -> Sequence[Comotion]:
        """The same without the objects that only other hands transport."""
        transported = {pair.track.id for pair in self.transporting}
        return [pair for pair in self.own if pair in self.transporting or pair.track.id not in transported]


def gather(
    action: Action, actor: Actor, hands: HandTracks, tracks: Sequence[ObjectTrack], settings: Settings
) -> Evidence:
    """Gather the evidence; the hand that may have acted is the marked one, else that of the moving arm, else either."""
    side = action.hand or PART_HANDS.get(action.part)
    sides = BOTH_HANDS if side is None else (side,)
    at_postures_m = stacked([track.at(actor.stamps_ns) for track in tracks], len(actor.stamps_ns), 3)
    objects_ego = actor.to_ego(at_postures_m)
    near = _proximities(tracks, objects_ego, actor, sides)
    return Evidence(action, sides, actor, hands, tracks, objects_ego, near, settings)


def pairs_of(
    tracks: Sequence[ObjectTrack], hands: Sequence[HandTrack], within_m: float, settings: Settings
) -> list[Comotion]:
    """Pair hands with the objects that may have come as close to them as `within_m`."""
    close = np.argwhere(gaps_m(hands, tracks) <= within_m).tolist()
    return [comotion(hands[hand], tracks[track], settings.reach_m, settings.moved_m) for hand, track in close]


def smallest_distances(objects_ego: Array, hands_ego: Array) -> Array:
    """Compute min over the segment of PM = ||O - hand||_2 in metres, (objects, hands); infinite for an unknown hand.

    Both arguments are (objects or hands, p, 3) in metres in the actor's egocentric frame, NaN where unknown (paper,
    section 2.2).
    """
    distances = np.linalg.norm(objects_ego[:, None] - hands_ego, axis=3)
    smallest: Array = np.fmin.reduce(distances, axis=2, initial=np.inf)
    return smallest


def _proximities(
    tracks: Sequence[ObjectTrack], objects_ego: Array, actor: Actor, sides: Sequence[Hand]
) -> list[Proximity]:
    """Measure the smallest distance of a hand to each object, where one is known."""
    hands_ego = np.array([actor.hand_m(side) for side in sides])
    distances_m = smallest_distances(objects_ego, hands_ego).tolist()
    nearest = [min(zip(of_hands, sides, strict=True), key=lambda each: each[0]) for of_hands in distances_m]
    return [
        Proximity(track, distance_m, side)
        for track, (distance_m, side) in zip(tracks, nearest, strict=True)
        if math.isfinite(distance_m)
    ]


def _concerned(tracks: Sequence[ObjectTrack], hands: HandTracks, settings: Settings) -> list[Comotion]:
    """Pair everyone's hands with the objects that came within a held tool's reach of an own hand, or were displaced.

    Only the nearest `MOST_OBJECTS` count, the nearest one first.
    """
    of_actor = list(hands.own.values())
    own = pairs_of(tracks, of_actor, settings.reach_with_tool_m + BEYOND_M, settings)
    nearest_m: dict[ObjectTrack, float] = {}
    for pair in own:
        nearest_m[pair.track] = min(float(pair.distances_m.min()), nearest_m.get(pair.track, np.inf))
    nearest = sorted(nearest_m, key=nearest_m.__getitem__)[:MOST_OBJECTS]
    concerned = [
        track
        for track in nearest
        if nearest_m[track] <= settings.reach_with_tool_m or track.is_displaced(settings.moved_m)
    ]
    kept = [pair for pair in own if pair.track in concerned]
    nearest_first = sorted(kept, key=lambda pair: (of_actor.index(pair.hand), concerned.index(pair.track)))
    return nearest_first + pairs_of(concerned, hands.others, settings.reach_m, settings)
