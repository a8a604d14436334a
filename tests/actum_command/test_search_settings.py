"""The settings of the search are written so that the classifier reads the same."""

import shlex
from pathlib import Path

import pytest

from actum.command_line import from_command_line
from actum_command.search_settings import (
    OtherSettingsError,
    flags_for,
    refuse_other_settings,
    segmentation_of,
    settings_file,
)
from som_classifier.segmentation import Segmentation
from som_classifier.settings import Settings
from som_classifier.spotting.spotted import SpottingOptions

PICKED = [
    Segmentation(),
    Segmentation(options=SpottingOptions(0.5)),
    Segmentation(options=SpottingOptions(2.0, 0.5, {"wave": 3.0, "pick up": 0.5}, frozenset({"push", 'the "pull"'}))),
    Segmentation(options=SpottingOptions(cooldown_s={"grüßen": 1.0}), enabled=frozenset({"grüßen", "clap"})),
]


@pytest.mark.parametrize("picked", PICKED)
def test_the_file_says_what_was_picked(picked: Segmentation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "settings.toml").write_text(settings_file(picked, "picked by hand"), encoding="utf-8")
    monkeypatch.setenv("ACTUM_CONFIG", str(tmp_path / "settings.toml"))
    assert Settings().segmentation == picked
    refuse_other_settings(tmp_path / "settings.toml")


@pytest.mark.parametrize("picked", PICKED)
def test_the_flags_say_the_same(picked: Segmentation) -> None:
    assert from_command_line(Settings, "som_classifier", shlex.split(flags_for(picked))).segmentation == picked


def test_a_file_that_holds_other_settings_is_left_alone(tmp_path: Path) -> None:
    file = tmp_path / "actum.toml"
    refuse_other_settings(file)
    file.write_text('model = "m.npz"\nsensor = "left"\nshortest_pause_s = 1.0\n')
    with pytest.raises(
        OtherSettingsError, match=r"also sets model, sensor, which overwriting the file would delete: write"
    ):
        refuse_other_settings(file)
    file.write_text("no toml")
    with pytest.raises(OtherSettingsError, match="is not a TOML file"):
        refuse_other_settings(file)


def test_flags_win_over_the_environment_and_marks_are_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_SHORTEST_PAUSE_S", "0.4")
    monkeypatch.setenv("ACTUM_DISABLED_ACTIONS", "push")
    monkeypatch.setenv("ACTUM_SEGMENTS", "marks")
    segmentation = segmentation_of({"shortest_pause_s": ["0.7"]})
    assert segmentation == Segmentation("auto", SpottingOptions(shortest_pause_s=0.7, disabled=frozenset({"push"})))
