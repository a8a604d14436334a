"""Looks a preset up by name, and changes its settings."""

from collections.abc import Sequence

from som_classifier.presets import PAPER, PRESETS, Preset


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
    changes = dict(setting.partition("=")[::2] for setting in settings)
    if changes and not preset.choices:
        raise PresetError(
            f"preset {name} has no settings: leave out --set, or use --preset {PAPER.name}, which has the settings "
            f"{', '.join(PAPER.choices)}"
        )
    for setting, value in changes.items():
        if value not in preset.choices.get(setting, ()):
            known = "; ".join(f"{each}={'|'.join(values)}" for each, values in preset.choices.items())
            raise PresetError(f"{setting}={value} is not a setting of preset {name}: use one or more of {known}")
    return preset.changed(changes) if changes else preset
