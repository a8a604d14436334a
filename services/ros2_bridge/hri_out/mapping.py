"""The mapping file: which actions are gestures and intents in the words of ROS4HRI, a YAML file."""

from enum import IntEnum
from pathlib import Path
from string import Formatter
from typing import Annotated, Any

import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from actum.calibration import YAML_ERRORS
from actum.messages import Event, Hand

LARGEST_BYTES = 100_000
"""At most this many bytes of a file are read: a mapping has some hundreds."""
ROLES = ("agent", "object", "goal", "recipient")
"""The keys of an intent's data: hri_actions_msgs calls them thematic roles."""
PLACEHOLDERS = ("person", "object", "label")
"""What stands in braces in a role: the person's id, the name of the object that was acted on, the action's label."""


class GestureName(IntEnum):
    """The constants of hri_msgs/Gesture but OTHER: actions that the mapping does not name are no gestures."""

    HANDS_ON_FACE = 1
    ARMS_CROSSED = 2
    LEFT_HAND_RAISED = 3
    RIGHT_HAND_RAISED = 4
    BOTH_HANDS_RAISED = 5
    WAVING = 6
    CLOSED_FIST = 7
    OPEN_PALM = 8
    POINTING_UP = 9
    THUMB_DOWN = 10
    THUMB_UP = 11
    VICTORY = 12
    LOVE = 13


INDEPENDENT, RIGHT, LEFT = range(3)
"""The constants of hri_msgs/Gesture for the hand."""
INTENT_NAMES = (
    *("ENGAGE_WITH", "MOVE_TO", "GUIDE", "GRAB_OBJECT", "BRING_OBJECT", "PLACE_OBJECT", "GREET", "SAY"),
    *("PRESENT_CONTENT", "PERFORM_MOTION", "START_ACTIVITY", "STOP_ACTIVITY", "WAKEUP", "SUSPEND"),
)
"""The constants of hri_actions_msgs/Intent; each stands for the text `__intent_<name in lower case>__`."""


class MappingError(ValueError):
    """A file that is no mapping; the text names the file, the field, and what to do."""


def _gesture(name: Any) -> Any:
    if isinstance(name, str) and name in GestureName.__members__:
        return GestureName[name]
    raise ValueError(f"{name!r} is not a gesture of hri_msgs: use one of {', '.join(GestureName.__members__)}")


def _named(name: str) -> str:
    if name in INTENT_NAMES:
        return f"__intent_{name.lower()}__"
    if name.isupper():
        raise ValueError(
            f"{name!r} is not an intent of hri_actions_msgs: use one of {', '.join(INTENT_NAMES)}, or a name of your "
            "own in lower case"
        )
    return name


def _role(text: str) -> str:
    try:
        named = [name for _, name, *_ in Formatter().parse(text) if name is not None]
    except ValueError as error:
        raise ValueError(
            f"the text {text!r} is not a format string ({error}): write {{{{ for {{ and }}}} for }}"
        ) from None
    for name in named:
        if name not in PLACEHOLDERS:
            raise ValueError(
                f"{{{name}}} is not a placeholder: use {', '.join(f'{{{each}}}' for each in PLACEHOLDERS)}"
            )
    return text


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


Label = Annotated[str, Field(min_length=1, max_length=200)]
Role = Annotated[str, Field(max_length=200), AfterValidator(_role)]


class GestureRule(_Part):
    """The gesture that an action is, and the hand, if it is always the same; else that of the event."""

    gesture: Annotated[GestureName, BeforeValidator(_gesture)]
    hand: Hand | None = None


class IntentRule(_Part):
    """The intent that an action expresses, and who is to do what to what: texts with `PLACEHOLDERS`."""

    intent: Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_named)]
    agent: Role | None = None
    object: Role | None = None
    goal: Role | None = None
    recipient: Role | None = None

    def data(self, event: Event, person: str) -> dict[str, str] | None:
        """Return the intent's data of an event; None where a role needs an object and no single one is known."""
        name = event.object.name if event.object and not event.candidates else ""
        known = {"person": person, "label": event.action or "", "object": name}
        texts = {role: text for role in ROLES if (text := getattr(self, role)) is not None}
        needed = {name for text in texts.values() for _, name, *_ in Formatter().parse(text) if name}
        if not all(known[name] for name in needed):
            return None
        return {role: text.format(**known) for role, text in texts.items()}


class Mapping(_Part):
    """Gestures and intents by the labels of actions."""

    gestures: dict[Label, GestureRule] = {}
    intents: dict[Label, IntentRule] = {}


def load(path: Path | None) -> Mapping:
    """Read a mapping; without a file no action is a gesture or an intent.

    Raises:
        MappingError: the file cannot be read or used.
    """
    if path is None:
        return Mapping()
    try:
        with path.open(encoding="utf-8") as file:
            content = yaml.safe_load(file.read(LARGEST_BYTES))
    except (OSError, UnicodeDecodeError) as error:
        raise MappingError(
            f"ros_hri_mapping: {path} cannot be read as text ({error}): give a text file in UTF-8"
        ) from None
    except YAML_ERRORS as error:
        raise MappingError(
            f"ros_hri_mapping: {path} is not YAML ({' '.join(str(error).split())}): correct this file"
        ) from None
    try:
        return Mapping.model_validate(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(map(str, first["loc"])) or "the file"
        problem = first["msg"].removeprefix("Value error, ")
        raise MappingError(f"ros_hri_mapping: {path}: {field}: {problem}") from None
