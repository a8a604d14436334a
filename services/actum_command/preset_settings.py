"""A preset by its name, with what is set otherwise of the paper's."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from som_classifier.attention import CHOICES
from som_classifier.presets import PAPER, PRESETS, PaperPreset, Preset

SETTINGS = "; ".join(f"{name}={'|'.join(values)}" for name, values in CHOICES.items())
"""What can be set of the paper's preset, in words."""


class PresetError(ValueError):
    """A preset or a setting that there is not: which, and which there are."""


def preset_named(name: str, settings: Sequence[str] = ()) -> Preset:
    """Look a preset up by name, and change what the settings, each NAME=VALUE, say of it.

    Raises:
        PresetError: there is no such preset, or it has no such setting.
    """
    if name not in PRESETS:
        raise PresetError(f"no preset {name!r}: use one of {', '.join(PRESETS)}")
    preset = PRESETS[name]
    changes: dict[str, Any] = dict(setting.partition("=")[::2] for setting in settings)
    if not changes:
        return preset
    if not isinstance(preset, PaperPreset):
        raise PresetError(f"preset {name} has nothing to set; {PAPER.name} has {', '.join(CHOICES)}")
    for setting, value in changes.items():
        if value not in CHOICES.get(setting, ()):
            raise PresetError(f"preset {name} knows no {setting}={value}; what it knows: {SETTINGS}")
    return replace(preset, posture=replace(preset.posture, **changes))
