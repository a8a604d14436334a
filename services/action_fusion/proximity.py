"""The paper's measure (section 2.2): an action is applied to the object that a hand came nearest to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.actors import Actor
from action_fusion.choice import Choice
from action_fusion.object_tracks import ObjectTrack
from action_fusion.settings import Settings
from actum.arrays import Array
from actum.messages import Hand


@dataclass(frozen=True)
class Proximity:
    """The smallest distance of a hand to an object, infinite where no hand is known, and the hand that came nearest."""

    track: ObjectTrack
    distance_m: float
    hand: Hand


def proximities(actor: Actor, tracks: Sequence[ObjectTrack], sides: Sequence[Hand]) -> list[Proximity]:
    """Measure the smallest distance of the hands on these sides to each object."""
    return [_proximity(actor, track, sides) for track in tracks]


def _proximity(actor: Actor, track: ObjectTrack, sides: Sequence[Hand]) -> Proximity:
    object_ego = actor.to_ego(track.at(actor.stamps_ns))
    distances_m = {side: smallest_distance(object_ego, actor.hand_m(side)) for side in sides}
    nearer = min(sides, key=distances_m.__getitem__)
    return Proximity(track, distances_m[nearer], nearer)


def smallest_distance(object_ego: Array, hand_ego: Array) -> float:
    """Compute min over the segment of PM = ||O - hand||_2 in metres; infinite where the hand is never known.

    Both arguments are (p, 3) in metres in the actor's egocentric frame, NaN where unknown.
    """
    distances = np.linalg.norm(object_ego - hand_ego, axis=1)
    return float(np.nanmin(distances)) if np.isfinite(distances).any() else np.inf


def nearest(near: Sequence[Proximity], settings: Settings) -> Choice | None:
    """Choose the object with the smallest distance within reach; a displaced object may be at a tool's distance."""
    moved_m, reach_m, reach_with_tool_m = settings.moved_m, settings.reach_m, settings.reach_with_tool_m
    reached = [
        one for one in near if one.distance_m <= (reach_with_tool_m if one.track.is_displaced(moved_m) else reach_m)
    ]
    best = min(reached, key=lambda one: one.distance_m, default=None)
    return None if best is None else Choice(best.track, best.hand)
