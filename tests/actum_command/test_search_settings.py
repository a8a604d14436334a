"""The settings of the search are written so that the classifier reads the same."""

import shlex
from pathlib import Path

import pytest
import typer

from actum.command_line import from_command_line
from actum_command.commands.evaluate_command import segmentation_of
from actum_command.commands.tune_command import flags_for, refuse_other_settings, settings_file
from som_classifier.segmentation import Segmentation
from som_classifier.settings import Settings
from som_classifier.spotting.spotted import SpottingOptions

PICKED = [
    Segmentation(),
    Segmentation(options=SpottingOptions(0.5)),
    Segmentation(options=SpottingOptions(2.0, 0.5, {"wave": 3.0, "pick up": 0.5}, frozenset({"push", 'the "pull"'}))),
    Segmentation(options=SpottingOptions(cooldown_s={"grüßen": 1.0}), enabled=frozenset({"grüßen", "clap"})),
    Segmentation(options=SpottingOptions(cooldown_s={"wave 👋": 1.0}, disabled=frozenset({"clap 👏"}))),
    Segmentation(
        options=SpottingOptions(cooldown_s={"up, down": 1.0, "a=b": 2.0}, disabled=frozenset({"left, right"}))
    ),
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


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            'model = "m.npz"\nsensor = "left"\nshortest_pause_s = 1.0\n',
            "also sets model, sensor, which would be lost",
        ),
        ("no toml", "is not a TOML file"),
    ],
)
def test_a_file_that_holds_other_settings_is_left_alone(
    content: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "actum.toml"
    refuse_other_settings(file)
    file.write_text(content)
    with pytest.raises(typer.Exit):
        refuse_other_settings(file)
    assert said in capsys.readouterr().err


def test_flags_win_over_the_environment_and_marks_are_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_SHORTEST_PAUSE_S", "0.4")
    monkeypatch.setenv("ACTUM_DISABLED_ACTIONS", "push")
    monkeypatch.setenv("ACTUM_SEGMENTS", "marks")
    segmentation = segmentation_of({"shortest_pause_s": ["0.7"]})
    assert segmentation == Segmentation("auto", SpottingOptions(shortest_pause_s=0.7, disabled=frozenset({"push"})))
