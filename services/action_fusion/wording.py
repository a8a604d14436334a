"""An event as a sentence, e.g. `push object 3 "cup", 0.21 m away, 0.94`."""

from action_fusion.choosing import NO_HAND, NO_OBJECT, Choice
from action_fusion.tracks import Track
from actum.messages import Action


def sentence(action: Action, choice: Choice, result: str | None) -> str:
    """Say the action, its object or objects, what was used, what became of it; an unknown action is said to be so."""
    what = f"unknown, most like {action.action}" if action.unknown else str(action.action)
    clauses = [what + _objects(choice), result or _absence(choice), f"{action.confidence:.2f}"]
    return ", ".join(clause for clause in clauses if clause)


def _objects(choice: Choice) -> str:
    if choice.evidence is None:
        return ""
    named = " or ".join(_name(e.track) for e in choice.likely)
    used = choice.held is not None and choice.held.id != choice.evidence.track.id
    return f" {named} with {_name(choice.held)}" if used and choice.held is not None else f" {named}"


def _name(track: Track) -> str:
    return f'object {track.id} "{track.name}"'


def _absence(choice: Choice) -> str | None:
    """Say why no object was chosen, where there were objects to choose from and a hand to choose by."""
    return None if choice.why in (NO_HAND, NO_OBJECT) else choice.why
