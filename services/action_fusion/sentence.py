"""An event as a sentence, e.g. `push object 3 "cup", 0.21 m away, 0.94`."""

from action_fusion.choice import NO_HAND, NO_OBJECT, Choice
from actum.messages import Action


def sentence(action: Action, choice: Choice, result: str | None) -> str:
    """Compose the sentence: the action or "unknown", the object or objects, the tool, the result, the confidence.

    The reason why no object was chosen takes the result's place, if an object was in sight and a hand known.
    """
    what = f"unknown, most like {action.action}" if action.unknown else str(action.action)
    why = None if choice.why in (NO_HAND, NO_OBJECT) else choice.why
    clauses = [what + _objects(choice), result or why, f"{action.confidence:.2f}"]
    return ", ".join(clause for clause in clauses if clause)


def _objects(choice: Choice) -> str:
    if choice.track is None:
        return ""
    named = " or ".join(track.label for track in choice.likely)
    tool = None if choice.held is None or choice.held.id == choice.track.id else choice.held
    return f" {named}" if tool is None else f" {named} with {tool.label}"
