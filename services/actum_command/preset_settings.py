"""Looks a preset up by name, and changes settings of the paper's preset."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from som_classifier.attention import CHOICES
from som_classifier.presets import PAPER, PRESETS, PaperPreset, Preset

SETTINGS = "; ".join(f"{name}={'|'.join(values)}" for name, values in CHOICES.items())
"""The settings of the paper's preset and their values, in words."""


class PresetError(ValueError):
    """An unknown preset or setting; the text names it and the known ones."""


def preset_named(name: str, settings: Sequence[str] = ()) -> Preset:
    """Return the preset of a name, changed by the settings, each NAME=VALUE.

    Raises:
        PresetError: there is no such preset, or it has no such setting.
    """
    if name not in PRESETS:
        raise PresetError(f"{name!r} is not a preset: use one of {', '.join(PRESETS)}")
    preset = PRESETS[name]
    changes: dict[str, Any] = dict(setting.partition("=")[::2] for setting in settings)
    if not changes:
        return preset
    if not isinstance(preset, PaperPreset):
        raise PresetError(
            f"preset {name} has no settings: leave out --set, or use --preset {PAPER.name}, which has the settings "
            f"{', '.join(CHOICES)}"
        )
    for setting, value in changes.items():
        if value not in CHOICES.get(setting, ()):
            raise PresetError(f"{setting}={value} is not a setting of preset {name}: use one or more of {SETTINGS}")
    return replace(preset, posture=replace(preset.posture, **changes))
