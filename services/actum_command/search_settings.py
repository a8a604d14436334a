"""The settings of the search for actions: read as the classifier reads them, written as flags and as its file."""

import json
import shlex
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from actum.command_line import from_command_line
from actum_command.service_settings import Given, arguments_of, flag_of
from som_classifier.segmentation import Segmentation
from som_classifier.settings import Settings

CLASSIFIER = "som_classifier"
"""The service whose settings they are."""
SEARCH_SETTINGS = (
    "false_alarms_per_min",
    "shortest_pause_s",
    "cooldown_s",
    "enabled_actions",
    "disabled_actions",
)


class OtherSettingsError(ValueError):
    """A file that is to be written holds other settings; the text says what to do."""


def segmentation_of(given: Given) -> Segmentation:
    """Return what a classifier with these flags finds by itself; others come from the environment and `ACTUM_CONFIG`.

    Raises:
        ValueError: they cannot be used.
    """
    settings = from_command_line(Settings, CLASSIFIER, arguments_of(CLASSIFIER, given))
    return replace(settings.segmentation, segments="auto")


def flags_for(segmentation: Segmentation) -> str:
    """Write the settings that are not as by default as flags for a shell; "" where all are."""
    return shlex.join(
        f"{flag_of(name)}={value if not isinstance(value, dict | list) else _as_flag(value)}"
        for name, value in _set(segmentation)
    )


def settings_file(segmentation: Segmentation, origin: str) -> str:
    """Write the settings that are not as by default as a file for `ACTUM_CONFIG`; its first line says their origin."""
    lines = [f"{name} = {_as_toml(value)}" for name, value in _set(segmentation)]
    return "\n".join([f"# {origin}", *(lines or ["# the model does best as it is: nothing is to be set"]), ""])


def refuse_other_settings(file: Path) -> None:
    """Refuse to write where a file holds what is none of these settings.

    Raises:
        OtherSettingsError: it does.
        OSError: it cannot be read.
    """
    try:
        held = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    except (tomllib.TOMLDecodeError, UnicodeDecodeError):
        raise OtherSettingsError(f"{file} already exists and is not a TOML file: give another file") from None
    if others := sorted(held.keys() - set(SEARCH_SETTINGS)):
        raise OtherSettingsError(
            f"{file} also sets {', '.join(others)}, which overwriting the file would delete: write to another file, "
            f"then copy the new lines into {file}"
        )


def _set(segmentation: Segmentation) -> Iterator[tuple[str, float | dict[str, float] | list[str]]]:
    """Yield name and value of each setting that is not as by default."""
    options = segmentation.options
    values = (
        options.false_alarms_per_min,
        options.shortest_pause_s,
        dict(options.cooldown_s),
        sorted(segmentation.enabled),
        sorted(options.disabled),
    )
    yield from ((name, value) for name, value in zip(SEARCH_SETTINGS, values, strict=True) if value)


def _as_flag(value: dict[str, float] | list[str]) -> str:
    parts = value if isinstance(value, list) else [f"{action}={seconds:g}" for action, seconds in value.items()]
    return ",".join(parts)


def _as_toml(value: float | dict[str, float] | list[str]) -> str:
    """Write a value in TOML, whose strings are JSON's."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{json.dumps(name)} = {seconds}' for name, seconds in value.items())}}}"
    return json.dumps(value, ensure_ascii=False)
