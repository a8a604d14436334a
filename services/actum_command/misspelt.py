"""Finds misspelt settings: each service ignores the settings of others, so none notices one that nobody has."""

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

from actum_command.service_settings import SETTINGS
from actum_command.spelling import nearest

PREFIX = "ACTUM_"
FILE = PREFIX + "CONFIG"
OTHERS = ("camera_device", "config", "data", "log", "models", "parent", "router_port", "videos")
"""The `ACTUM_…` variables that are no settings of services: the runtime, the compose files or the tests read them."""

KNOWN = sorted({name for settings in SETTINGS.values() for name in settings.model_fields})
"""The settings of all services."""


def misspelt(environment: Mapping[str, str]) -> Iterator[str]:
    """Yield a line for each name that is no setting, in the file that `ACTUM_CONFIG` names and in the environment.

    Raises:
        OSError, ValueError: the file cannot be read.
    """
    file = environment.get(FILE)
    for name in tomllib.loads(Path(file).read_text(encoding="utf-8")) if file else ():
        if name not in KNOWN:
            yield f"{file}: {name} is not a setting{_suggestion(name)}"
    for name in environment:
        setting = name.removeprefix(PREFIX).lower()
        if name.startswith(PREFIX) and setting not in (*KNOWN, *OTHERS):
            yield f"{name} is not a setting{_suggestion(setting, PREFIX)}"


def _suggestion(name: str, prefix: str = "") -> str:
    return "".join(f": did you mean {prefix + (one.upper() if prefix else one)}?" for one in nearest(name, KNOWN))
