"""Names that people give to sets, actions, people and files: some become file names, so that little is allowed."""

import re
from typing import Annotated
from unicodedata import normalize

from pydantic import AfterValidator, Field

LONGEST = 64
"""Characters of a name: it fits a line of a list, and a file name."""
NAME = re.compile(r"[^\W_][\w .-]*")
"""Letters and digits of any script, space, `_`, `-` and `.`; the first is a letter or a digit."""
LONGEST_BYTES = 200
"""Bytes of a name as UTF-8: file systems allow 255 for a file name with its ending."""

LEARNED = "the model would report it whenever people do nothing in particular"
ANSWERED = "the system reports it when it recognises no action"
DENIED = "it labels what looks like an action and is none"
NO_ACTIONS = {"background": LEARNED, "idle": LEARNED, "none": DENIED, "unknown": ANSWERED}
"""Names that no action is given, and why."""


def checked_name(name: str) -> str:
    """Return a name in its composed Unicode form (NFC).

    Raises:
        ValueError: it holds another character than letters, digits, space, `_`, `-` and `.`, or is too long.
    """
    composed = normalize("NFC", name)
    size = len(composed.encode(errors="replace"))
    if len(composed) > LONGEST or size > LONGEST_BYTES:
        raise ValueError(
            f"the name has {len(composed)} characters ({size} bytes in UTF-8): use at most {LONGEST} characters and "
            f"{LONGEST_BYTES} bytes"
        )
    if not composed:
        raise ValueError("the name is empty: enter a name")
    if not NAME.fullmatch(composed) or composed[-1] in " .":
        raise ValueError(
            f"{composed!r} cannot be a name: use letters, digits, spaces, '_', '-' and '.', begin with a letter or "
            "digit, and end with neither a space nor a full stop"
        )
    return composed


def checked_label(name: str) -> str:
    """Return the name of an action in its composed Unicode form (NFC).

    Raises:
        ValueError: it is no name, or one that means that no action is done.
    """
    label = checked_name(name)
    if cause := NO_ACTIONS.get(label.casefold()):
        raise ValueError(
            f"{label!r} cannot be the name of an action, because {cause}: use another name. To record people who do "
            "none of the actions, record background instead"
        )
    return label


Name = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(checked_name)]
"""A name, checked."""
Label = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(checked_label)]
"""The name of an action, checked. Names of devices, such as `con`, are allowed: labels stand in no file name."""
LabelOrNone = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(lambda text: text and checked_label(text))]
"""The name of an action, or an empty text for background."""
NameOrNone = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(lambda text: text and checked_name(text))]
"""A name, or an empty text where nobody gave one."""
SetName = Annotated[str, Field(max_length=200), AfterValidator(lambda text: normalize("NFC", text))]
"""The name of a set that is there, whatever somebody has called its folder; it is looked up, never made into a path."""
Id = Annotated[str, Field(min_length=1, max_length=400)]
"""What a reply has called something by; it is looked up, never made into a path."""
