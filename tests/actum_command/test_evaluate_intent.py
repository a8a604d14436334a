"""`actum evaluate --intent` prints how early contacts are foreseen, and refuses options of models of actions."""

import json
from pathlib import Path

import pytest

from actum.messages import Objects, Segment
from actum.recorder import write_recording
from command_lines import printed, refused
from reaching import messages


@pytest.fixture(scope="module")
def reaches(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("reaches"))


def written(folder: Path, *left_out: type) -> Path:
    path = folder / "a.mcap"
    kept = (message for message in messages() if not isinstance(message, left_out))
    write_recording(path, sorted(kept, key=lambda message: message.stamp_ns or 0), person="1", source="test")
    return path


def test_contacts_are_counted_and_compared_with_what_is_simpler(reaches: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.json"
    told = printed("evaluate", "--intent", reaches, "--json", report)
    assert "3 contacts in 0.2 min, labelled actions without a contact: 1" in told
    assert "false alarms a minute" in told and "(ECE)" in told
    for method in ("actum", "nearest object", "constant velocity", "minimum jerk", "never"):
        assert any(line.strip().startswith(method) for line in told.splitlines()), told
    numbers = json.loads(report.read_text())
    assert numbers["contacts"] == 3
    assert f"{numbers['methods']['actum']['ahead_s']:.2f} s" in told


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (("--continuous",), "--continuous"),
        (("--leave-one-person-out", "--jobs", "2"), "--leave-one-person-out and --jobs"),
        (("--preset", "paper", "--set", "axes=posture"), "--preset and --set"),
        (("--seed", "1"), "--seed"),
        (("--cooldown-s", "3"), "--cooldown-s"),
    ],
)
def test_options_of_models_are_refused_before_anything_is_read(flags: tuple[str, ...], named: str) -> None:
    said = refused("evaluate", "--intent", "nowhere.mcap", *flags)
    assert said.endswith(
        f"--intent does not use a model of actions, so {named} would have no effect: leave out {named}"
    )


def test_recordings_without_objects_are_refused(tmp_path: Path) -> None:
    assert "show no person and tracked object at the same time" in refused(
        "evaluate", "--intent", written(tmp_path, Objects)
    )


def test_recordings_without_labelled_actions_are_refused(tmp_path: Path) -> None:
    said = refused("evaluate", "--intent", written(tmp_path, Segment))
    assert "contain no contact of a hand with an object (0 labelled actions, all without contact)" in said
