from pathlib import Path

import pytest
from typer.testing import CliRunner

from actum_command.__main__ import app

COMMANDS = (
    "demo", "up", "router", "watch", "doctor", "segment start", "segment end", "segment toggle", "record", "play",
    "import msr-action3d", "import utkinect", "train", "evaluate", "inspect", "simulate", "scene", "markers",
    "calibrate intrinsics", "calibrate extrinsics", "import video", "models fetch", "draw",
)  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str) -> None:
    asked = CliRunner().invoke(app, [*command.split(), "--help"])
    assert asked.exit_code == 0
    assert "Usage" in asked.output


def refusal(*arguments: str) -> str:
    refused = CliRunner().invoke(app, list(arguments))
    assert refused.exit_code == 1, refused.output
    return " ".join(refused.stderr.split())


def test_what_is_no_recording_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_text("nothing of the kind")
    assert "a.mcap" in refusal("train", str(tmp_path), "-o", str(tmp_path / "m.npz"))


def test_a_folder_without_recordings_is_refused(tmp_path: Path) -> None:
    assert "no recordings" in refusal("train", str(tmp_path), "-o", str(tmp_path / "m.npz"))


def test_a_foreign_model_is_refused_with_the_remedy(tmp_path: Path) -> None:
    (tmp_path / "m.npz").write_bytes(b"PK not a model")
    assert "actum train" in refusal("evaluate", str(tmp_path / "m.npz"), str(tmp_path))


def test_an_unknown_preset_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    assert CliRunner().invoke(app, ["simulate", str(tmp_path / "a.mcap"), "--repetitions", "1"]).exit_code == 0
    message = refusal("train", str(tmp_path), "-o", str(tmp_path / "m.npz"), "--preset", "best")
    assert "no preset" in message
    assert "paper" in message


def test_training_and_evaluating_on_simulated_examples(tmp_path: Path) -> None:
    runner = CliRunner()
    assert runner.invoke(app, ["simulate", str(tmp_path / "a.mcap"), "--repetitions", "2"]).exit_code == 0
    trained = runner.invoke(app, ["train", str(tmp_path / "a.mcap"), "-o", str(tmp_path / "m.npz")])
    assert "10 samples of 5 actions" in " ".join(trained.output.split())
    report = tmp_path / "report.json"
    command = ["evaluate", str(tmp_path / "m.npz"), str(tmp_path / "a.mcap"), "--json", str(report)]
    assert "accuracy" in runner.invoke(app, command).output
    assert '"predictions"' in report.read_text()


def test_an_unknown_topic_to_watch_is_refused_with_the_known_ones() -> None:
    assert "event" in refusal("watch", "everything")
