"""Choice of the object that an action is applied to: by the pointing ray, by proximity, or by the interaction."""

import math
from collections.abc import Sequence

from action_fusion.actors import Actor
from action_fusion.choice import LEFT_ALONE, NO_HAND, NO_OBJECT, OUT_OF_REACH, Choice
from action_fusion.hand_tracks import HandTracks
from action_fusion.interaction import displaced_by_others, interacted_with
from action_fusion.pointing_ray import pointed_at
from action_fusion.proximity import Proximity, nearest
from action_fusion.settings import Settings
from actum.messages import Action, Hand

MOST_NAMED = 3
"""Most objects moved by another person that the reason names: more would make it too long to read."""


def choose(
    action: Action,
    proximities: Sequence[Proximity],
    actor: Actor,
    hands: HandTracks,
    sides: Sequence[Hand],
    settings: Settings,
) -> Choice:
    """Choose the object by the measure that the action and the settings select.

    Args:
        action: the recognised action.
        proximities: the objects, and the smallest distances of the actor's hands to them.
        actor: the actor's postures in the segment itself.
        hands: the tracks of all hands, from some time before the segment to its end.
        sides: the actor's hands that may have acted.
        settings: thresholds and labels.
    """
    if not proximities:
        return Choice(why=NO_OBJECT)
    if action.action in settings.pointing_labels:
        return pointed_at([one.track for one in proximities], actor, sides, settings)
    near = [one for one in proximities if math.isfinite(one.distance_m)]
    if not near:
        return Choice(why=NO_HAND)
    if settings.measure == "proximity":
        choice = nearest(near, settings)
    else:
        may_use_tool = action.action not in settings.expected_outcomes
        choice = interacted_with([one.track for one in near], hands, sides, may_use_tool, settings)
    return choice or Choice(why=_why_none(near, hands, settings))


def _why_none(near: Sequence[Proximity], hands: HandTracks, settings: Settings) -> str:
    """Return the reason why no object was chosen, and name the objects that another person moved."""
    why = LEFT_ALONE if any(one.distance_m <= settings.reach_m for one in near) else OUT_OF_REACH
    displaced = displaced_by_others([one.track for one in near], hands, settings)
    named = " and ".join(track.label for track in displaced[:MOST_NAMED])
    return f"{why}; another moved {named}" if displaced else why
