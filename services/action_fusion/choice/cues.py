"""The cues by which the object of an action is chosen, and their order."""

from collections.abc import Callable, Mapping

from action_fusion.choice.evidence import LEFT_ALONE, NO_HAND, NO_OBJECT, OUT_OF_REACH, Choice, Evidence
from action_fusion.choice.moved import displaced_by_others, held, moved_at_hand, released, sent_away
from action_fusion.choice.pointing import pointed_at
from action_fusion.choice.reaching import reached

MOST_NAMED = 3
"""Most objects moved by another person that the reason names: more would make it too long to read."""

Cue = Callable[[Evidence], Choice | None]
"""A cue chooses an object, or returns None where its evidence is missing: the next cue is then asked."""


def nearest(evidence: Evidence) -> Choice | None:
    """Choose the object with the smallest distance within reach; a displaced object may be at a tool's distance.

    This is the paper's measure (section 2.2).
    """
    settings, in_reach = evidence.settings, []
    for one in evidence.near:
        displaced = one.track.is_displaced(settings.moved_m)
        if one.distance_m <= (settings.reach_with_tool_m if displaced else settings.reach_m):
            in_reach.append(one)
    best = min(in_reach, key=lambda one: one.distance_m, default=None)
    return None if best is None else Choice(best.track, (best.hand,))


CUES: Mapping[str, tuple[Cue, ...]] = {
    "pointing": (pointed_at,),
    "proximity": (nearest,),
    "joint": (held, moved_at_hand, reached, released, sent_away),
}
"""The cues of each measure, the surest one first: the first cue that chooses an object decides.

Each of these cues looks at one hand at a time. A cue for an action of both hands belongs before `held`. It finds both
hands in `Evidence.hands`, because `Evidence.own` often has only the hand that moved most, and names them in
`Choice.hands`.
"""


def choose(evidence: Evidence) -> Choice:
    """Choose the object by the measure that the action and the settings select."""
    if not evidence.tracks:
        return Choice(why=NO_OBJECT)
    points = evidence.action.action in evidence.settings.pointing_labels
    if not points and not evidence.near:
        return Choice(why=NO_HAND)
    for cue in CUES["pointing" if points else evidence.settings.measure]:
        if (choice := cue(evidence)) is not None:
            return choice
    return Choice(why=_why_none(evidence))


def _why_none(evidence: Evidence) -> str:
    """Return the reason why no object was chosen, and name the objects that another person moved."""
    in_reach = any(one.distance_m <= evidence.settings.reach_m for one in evidence.near)
    why = LEFT_ALONE if in_reach else OUT_OF_REACH
    displaced = displaced_by_others(evidence)
    named = " and ".join(track.label for track in displaced[:MOST_NAMED])
    return f"{why}; another moved {named}" if displaced else why
