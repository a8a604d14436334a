"""`actum tune` picks settings, says what they cost, and writes what `actum evaluate` and the classifier read."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import pytest

from actum.recording import Recording
from command_lines import printed, refused
from days import days, searching_model


@dataclass(frozen=True)
class Desk:
    """A model that was trained on persons 1 and 2, and the recordings of all three."""

    model: Path
    recordings: list[Recording]

    @property
    def third(self) -> Path:
        return self.recordings[2].path


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Desk:
    folder = tmp_path_factory.mktemp("tuning")
    recordings = days(folder)
    searching_model(recordings[:2]).save(folder / "m.npz")
    return Desk(folder / "m.npz", recordings)


def run(*arguments: object) -> str:
    return " ".join(printed(*arguments).split())


def test_the_numbers_are_those_of_evaluate_with_the_file_and_with_the_flags(
    desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = run("tune", desk.model, desk.third, "--false-alarms-per-min", 0.5, "-o", tmp_path / "new" / "s.toml")
    right, done, f1 = re.findall(r"as picked: (\d+) of (\d+) found, events F1 ([\d.]+)", told)[0]
    flags = shlex.split(told.partition("as flags: ")[2].partition(" written to")[0])
    by_flags = run("evaluate", "--continuous", desk.model, desk.third, *flags)
    monkeypatch.setenv("ACTUM_CONFIG", str(tmp_path / "new" / "s.toml"))
    by_file = run("evaluate", "--continuous", desk.model, desk.third)
    for evaluated in (by_flags, by_file):
        assert f"{right} of {done} actions found" in evaluated
        assert f"events F1 {f1}" in evaluated


def test_settings_change_what_is_evaluated_and_are_named(desk: Desk) -> None:
    told = run("evaluate", "--continuous", desk.model, desk.third, "--disabled-actions", "lift,push,swing")
    assert "with --disabled-actions=lift,push,swing" in told
    assert "0 of 6 actions found" in told


@pytest.mark.long
def test_several_recordings_are_also_held_against_settings_picked_on_the_others(desk: Desk) -> None:
    told = run("tune", desk.model, *(recording.path for recording in desk.recordings))
    assert "picked on all other recordings in turn:" in told
    assert "the model was trained on person 1, 2" in told


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--disabled-actions", "wvae"), "settings name actions that the model does not know: wvae"),
        (("--shortest-pause-s", "-1"), "shortest_pause_s"),
        (
            ("--cooldown-s", "lift"),
            "'lift' is not of the form ACTION=SECONDS: give each action a number of seconds, such as wave=3,clap=1",
        ),
    ],
)
def test_settings_that_cannot_be_used_are_refused(desk: Desk, options: tuple[str, str], reason: str) -> None:
    assert reason in refused("evaluate", "--continuous", desk.model, desk.third, *options)


def test_settings_of_the_search_are_refused_where_nothing_is_searched(desk: Desk) -> None:
    said = refused("evaluate", desk.model, desk.third, "--shortest-pause-s", "1")
    assert "--shortest-pause-s works only together with --continuous: add --continuous" in said


def test_what_cannot_be_tuned_is_refused_before_the_work(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text('model = "m.npz"\n')
    assert "also sets model" in refused("tune", desk.model, desk.third, "-o", tmp_path / "own.toml")
    assert "does not end in .toml" in refused("tune", desk.model, desk.third, "-o", tmp_path / "own.txt")
    assert "--false-alarms-per-min is 0: give a number above 0" in refused(
        "tune", desk.model, desk.third, "--false-alarms-per-min", 0
    )


@pytest.mark.thorough
def test_the_picture_of_a_recording_also_shows_what_a_model_finds(desk: Desk, tmp_path: Path) -> None:
    run("label", "picture", desk.third, "--model", desk.model, "-o", tmp_path / "stream.svg")
    drawn = (tmp_path / "stream.svg").read_text(encoding="utf-8")
    assert all(f">{name}<" in drawn for name in ("answer", "found"))
