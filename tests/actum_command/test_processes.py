"""Which programs a whole system is, and with which settings."""

from pathlib import Path

import pytest
import typer

from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.commands.watch_command import watch
from actum_command.model_in_use import ModelInUse


def environment_of_tracker(given: dict[str, bool | list[str]]) -> dict[str, str]:
    programs = processes.system(ServiceSettings(), "simulator", ModelInUse(Path("model.npz")), given)
    (tracker,) = [program for program in programs if program.name == "marker_tracker"]
    return dict(tracker.environment)


def test_the_tracker_knows_the_simulated_objects_unless_a_scene_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "ACTUM_OBJECTS" in environment_of_tracker({})
    assert "ACTUM_OBJECTS" not in environment_of_tracker({"scene": ["deploy/objects.example.yaml"]})
    monkeypatch.setenv("ACTUM_SCENE", "deploy/objects.example.yaml")
    assert "ACTUM_OBJECTS" not in environment_of_tracker({})


@pytest.mark.parametrize("name", ["event", "events"])
def test_topics_to_watch_may_be_named_in_the_plural(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "none.txt").touch()
    with pytest.raises(typer.Exit):
        watch([name], recorded=[tmp_path])
    assert "no recordings in" in capsys.readouterr().err
