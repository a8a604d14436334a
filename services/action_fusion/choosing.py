"""The object of an action: by where the arm points, by the paper's plain proximity, or by the joint decision."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion import proximity
from action_fusion.decision import decide, moved_by_others
from action_fusion.hands import Hands
from action_fusion.proximity import Actor
from action_fusion.samples import Array
from action_fusion.settings import Settings
from action_fusion.tracks import Track
from actum.messages import Action, Hand, Pointing

NO_HAND = "the hand is not known"
NO_OBJECT = "no object in sight"
OUT_OF_REACH = "no object within reach"
LEFT_ALONE = "no object within reach was acted on"
OFF_THE_LINE = "no object along the arm"

MOST_NAMED = 3
"""More objects that another moved are not named."""

CLEARLY = 0.5
"""One line fits clearly better than another where an object is off it by less than this part of the angle."""


@dataclass(frozen=True)
class Evidence:
    """What speaks for one object: how near which hand came, and how well the arm that is out points at it."""

    track: Track
    distance_m: float
    near_hand: Hand
    angle: float
    pointing_hand: Hand


@dataclass(frozen=True)
class Choice:
    """The object acted on, its rivals (as likely, or nearly), and what is in the hand; or why there is none."""

    evidence: Evidence | None = None
    hand: Hand | None = None
    held: Track | None = None
    rivals: tuple[Evidence, ...] = ()
    pointing: Pointing | None = None
    why: str | None = None

    @property
    def likely(self) -> tuple[Evidence, ...]:
        """The object and its rivals, the likeliest first."""
        return () if self.evidence is None else (self.evidence, *self.rivals)


def evidence(tracks: Sequence[Track], actor: Actor, hands: Sequence[Hand]) -> list[Evidence]:
    """Measure how near each hand came to each object, and how the arm that is out points at it."""
    pointing_hand = proximity.pointing_hand(actor, hands)
    views = [actor.view(track) for track in tracks]
    angles = _angles(views, actor, pointing_hand)
    found = []
    for track, view, angle in zip(tracks, views, angles, strict=True):
        distances = {hand: proximity.smallest_distance(view, actor.hand(hand)) for hand in hands}
        near_hand = min(hands, key=distances.__getitem__)
        found.append(Evidence(track, distances[near_hand], near_hand, angle, pointing_hand))
    return found


def _angles(views: Sequence[Array], actor: Actor, hand: Hand) -> list[float]:
    """Measure how far each object is off the line from head to finger or, where that fits clearly better, the arm's.

    Most hold the finger where they look, some point with the stretched arm.
    """
    sight = [proximity.pointing_angle(view, actor.fingertip(hand), actor.head()) for view in views]
    arm = [proximity.pointing_angle(view, actor.hand(hand), actor.shoulder(hand)) for view in views]
    with_arm = bool(sight) and math.isfinite(min(sight)) and min(arm) < CLEARLY * min(sight)
    return arm if with_arm else sight


def choose(
    action: Action,
    found: Sequence[Evidence],
    paths: Hands,
    hands: Sequence[Hand],
    settings: Settings,
) -> Choice:
    """Choose the object by the measure that the action and the settings ask for."""
    if not found:
        return Choice(why=NO_OBJECT)
    if action.action in settings.pointing_labels:
        return _pointed_at(found, settings)
    near = [e for e in found if math.isfinite(e.distance_m)]
    if not near:
        return Choice(why=NO_HAND)
    if settings.measure == "proximity":
        return _nearest(near, paths, settings)
    return _jointly(action, near, paths, hands, settings)


def _jointly(
    action: Action, near: Sequence[Evidence], paths: Hands, hands: Sequence[Hand], settings: Settings
) -> Choice:
    applies = action.action not in settings.expected_outcomes
    decision = decide(paths, [e.track for e in near], hands, applies, settings)
    if decision is None:
        return Choice(why=_why_none(near, paths, settings))
    of_track = {e.track.id: e for e in near}
    rivals = tuple(of_track[track.id] for track in decision.rivals)
    return Choice(of_track[decision.track.id], decision.hand, decision.held, rivals)


def _why_none(near: Sequence[Evidence], paths: Hands, settings: Settings) -> str:
    """Say why nothing was acted on, and name what another moved."""
    why = LEFT_ALONE if any(e.distance_m <= settings.reach_m for e in near) else OUT_OF_REACH
    moved = moved_by_others(paths, [e.track for e in near], settings)
    named = " and ".join(f'object {track.id} "{track.name}"' for track in moved[:MOST_NAMED])
    return f"{why}; another moved {named}" if moved else why


def _nearest(near: Sequence[Evidence], paths: Hands, settings: Settings) -> Choice:
    """Take the object with the smallest distance (paper, section 2.2), if it was reached.

    One that moved may have been reached with something.
    """
    reached = [e for e in near if e.distance_m <= (settings.reach_with_m if _moved(e, settings) else settings.reach_m)]
    if not reached:
        return Choice(why=_why_none(near, paths, settings))
    best = min(reached, key=lambda e: e.distance_m)
    return Choice(best, best.near_hand)


def _moved(of: Evidence, settings: Settings) -> bool:
    return float(np.linalg.norm(of.track.shift())) >= settings.moved_m


def _pointed_at(found: Sequence[Evidence], settings: Settings) -> Choice:
    """Take the object nearest to the line on which the actor points."""
    ranked = sorted((e for e in found if math.isfinite(e.angle)), key=lambda e: e.angle)
    if not ranked:
        return Choice(why=NO_HAND)
    best, angles = ranked[0], [math.degrees(e.angle) for e in ranked]
    if angles[0] > settings.pointing_limit_deg:
        return Choice(why=OFF_THE_LINE)
    closest = min(angles[0] + settings.pointing_uncertainty_deg, settings.pointing_limit_deg)
    rivals = tuple(e for e, angle in zip(ranked[1:], angles[1:], strict=True) if angle <= closest)
    margin = angles[1] - angles[0] if len(angles) > 1 else None
    return Choice(best, best.pointing_hand, None, rivals, Pointing(angle_deg=angles[0], margin_deg=margin))
