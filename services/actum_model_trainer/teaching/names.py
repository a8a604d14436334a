"""Names that people give to sets, actions, people and files: they stand in file names, so that little is allowed."""

import re
import unicodedata
from typing import Annotated

from pydantic import AfterValidator, Field

LONGEST = 64
"""Characters of a name: it fits a line of a list, and a file name."""
NAME = re.compile(r"[^\W_][\w .-]*")
"""Letters and digits of any script, space, `_`, `-` and `.`; the first is a letter or a digit."""
LONGEST_BYTES = 200
"""Bytes of a name as UTF-8: file systems allow 255 for a file name with its ending."""


def checked_name(name: str) -> str:
    """Return a name in its composed Unicode form (NFC).

    Raises:
        ValueError: it holds another character than letters, digits, space, `_`, `-` and `.`, or is too long.
    """
    composed = unicodedata.normalize("NFC", name)
    if len(composed) > LONGEST or len(composed.encode(errors="replace")) > LONGEST_BYTES:
        raise ValueError(f"a name has at most {LONGEST} characters")
    if not NAME.fullmatch(composed) or composed[-1] in " .":
        raise ValueError(
            "a name has letters, digits, spaces, '_', '-' and '.', begins with a letter or digit, "
            "and ends with neither a space nor a point"
        )
    return composed


Name = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(checked_name)]
"""A name, checked."""
NameOrNone = Annotated[str, Field(max_length=4 * LONGEST), AfterValidator(lambda text: text and checked_name(text))]
"""A name, or an empty text where nobody gave one."""
Id = Annotated[str, Field(min_length=1, max_length=400)]
"""What a reply has called something by; it is looked up, never made into a path."""
