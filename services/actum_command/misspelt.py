"""Finds misspelt words, such as settings: each service ignores the settings of others, so none notices a wrong name."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path

from actum_command.service_settings import SETTINGS

ALIKE = 0.75
"""Least similarity (0 to 1, difflib's ratio): two letters changed places in a word of five has 0.8."""

PREFIX = "ACTUM_"
CONFIG_FILE = PREFIX + "CONFIG"
OTHERS = ("camera_device", "config", "data", "log", "models", "parent", "router_port", "videos")
"""The `ACTUM_…` variables that are no settings of services: the runtime, the compose files or the tests read them."""

KNOWN = sorted({name for settings in SETTINGS.values() for name in settings.model_fields})
"""The settings of all services."""


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """Return the known word that is most like a word, or the one that begins with it; nothing where none does."""
    words = list(known)
    begun = [each for each in words if len(word) > 1 and each.startswith(word)]
    return get_close_matches(word, words, n=1, cutoff=ALIKE) or begun[:1]


def misspelt(environment: Mapping[str, str]) -> Iterator[str]:
    """Yield a line for each name that is no setting, in the file that `ACTUM_CONFIG` names and in the environment.

    Raises:
        OSError, ValueError: the file cannot be read.
    """
    file = environment.get(CONFIG_FILE)
    for name in tomllib.loads(Path(file).read_text(encoding="utf-8")) if file else ():
        if name not in KNOWN:
            yield f"{file}: {name} is not a setting{_suggestion(name)}"
    for name in environment:
        setting = name.removeprefix(PREFIX).lower()
        if name.startswith(PREFIX) and setting not in (*KNOWN, *OTHERS):
            yield f"{name} is not a setting{_suggestion(setting, PREFIX)}"


def _suggestion(name: str, prefix: str = "") -> str:
    return "".join(f": did you mean {prefix + (one.upper() if prefix else one)}?" for one in nearest(name, KNOWN))
