"""What cues judge, the evidence of a segment, and what they answer: a choice."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from action_fusion.settings import Settings
from action_fusion.tracks.actors import Actor
from action_fusion.tracks.comotion import Comotion, comotion, transporting
from action_fusion.tracks.hand_tracks import BOTH_HANDS, HandTrack, HandTracks
from action_fusion.tracks.object_tracks import ObjectTrack
from actum.arrays import Array
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
    """The smallest distance of a hand to an object, infinite where no hand is known, and the hand that came nearest."""

    track: ObjectTrack
    distance_m: float
    hand: Hand


@dataclass(frozen=True)
class Evidence:
    """All that is known of an action's segment, and how hands and objects moved relative to each other in it.

    Attributes:
        action: the recognised action.
        actor: the actor's postures in the segment itself.
        hands: the tracks of all hands, from some time before the segment to its end.
        tracks: those of the objects, over the same time.
        settings: thresholds and labels.
    """

    action: Action
    actor: Actor
    hands: HandTracks
    tracks: Sequence[ObjectTrack]
    settings: Settings

    @cached_property
    def sides(self) -> tuple[Hand, ...]:
        """The hands that may have acted: the one that the mark names, else that of the moving arm, else both."""
        side = self.action.hand or PART_HANDS.get(self.action.part)
        return BOTH_HANDS if side is None else (side,)

    @cached_property
    def near(self) -> list[Proximity]:
        """The objects with the hand that came nearest to each; none where no hand is known."""
        near = []
        for track in self.tracks:
            object_ego = self.actor.to_ego(track.at(self.actor.stamps_ns))
            distances_m = {side: smallest_distance(object_ego, self.actor.hand_m(side)) for side in self.sides}
            nearer = min(self.sides, key=distances_m.__getitem__)
            near.append(Proximity(track, distances_m[nearer], nearer))
        return [one for one in near if np.isfinite(one.distance_m)]

    @property
    def distances_m(self) -> dict[int, float]:
        """The smallest distance of a hand to each object, by its id; empty where no hand is known."""
        return {one.track.id: one.distance_m for one in self.near}

    @cached_property
    def pairs(self) -> list[Comotion]:
        """Each hand with each object that it may concern: displaced, or within reach of a tool in the actor's hands."""
        own, settings = list(self.hands.own.values()), self.settings
        distances_m = [min(_smallest_gap_m(one.track, hand) for hand in own) for one in self.near]
        nearest = sorted(zip(distances_m, self.near, strict=True), key=lambda near: near[0])[:MOST_OBJECTS]
        concerned = [
            one.track
            for distance_m, one in nearest
            if distance_m <= settings.reach_with_tool_m or one.track.is_displaced(settings.moved_m)
        ]
        return self.pairs_with(concerned)

    def pairs_with(self, tracks: Sequence[ObjectTrack]) -> list[Comotion]:
        """Pair everyone's hands with objects."""
        reach_m, moved_m = self.settings.reach_m, self.settings.moved_m
        return [comotion(hand, track, reach_m, moved_m) for hand in self.hands.everyones for track in tracks]

    @cached_property
    def transporting(self) -> frozenset[Comotion]:
        """The pairs in which the hand, anybody's, transports the object."""
        return transporting(self.pairs, self.settings.moved_m)

    @cached_property
    def own(self) -> list[Comotion]:
        """The pairs of the hands that may have acted: those of one hand, then those of the other."""
        acting = [self.hands.own[side] for side in self.sides if side in self.hands.own]
        return [pair for hand in acting for pair in self.pairs if pair.hand is hand]

    @cached_property
    def free(self) -> list[Comotion]:
        """The pairs in `own` without those whose object only other hands transport."""
        transported = {pair.track.id for pair in self.transporting}
        return [pair for pair in self.own if pair.track.id not in transported or pair in self.transporting]


def smallest_distance(object_ego: Array, hand_ego: Array) -> float:
    """Compute min over the segment of PM = ||O - hand||_2 in metres; infinite where the hand is never known.

    Both arguments are (p, 3) in metres in the actor's egocentric frame, NaN where unknown (paper, section 2.2).
    """
    distances = np.linalg.norm(object_ego - hand_ego, axis=1)
    return float(np.nanmin(distances)) if np.isfinite(distances).any() else np.inf


def _smallest_gap_m(track: ObjectTrack, hand: HandTrack) -> float:
    return float(np.linalg.norm(track.at(hand.stamps_ns) - hand.positions_m, axis=1).min())
