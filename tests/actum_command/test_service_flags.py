"""What the services can be told can be told to `actum up`, which starts them."""

import pytest
from typer.testing import CliRunner

from actum.command_line import from_command_line, placeholder
from actum.settings import ServiceSettings
from actum_command import processes, startup
from actum_command.__main__ import app
from actum_command.service_settings import DECLARED, SET_BY_UP
from actum_command.supervising import Program
from command_lines import invoke, printed


def up(*arguments: str) -> None:
    printed("up", *arguments)


def arguments_of(started: list[Program]) -> dict[str, list[str]]:
    return {program.name: list(program.arguments) for program in started}


def test_each_service_is_told_its_own_settings(started: list[Program]) -> None:
    up("--camera", "1", "--no-images", "--scene", "a.yaml", "--pointing-labels", "point", "--pointing-labels", "at")
    assert arguments_of(started) == {
        "sensor_gateway": ["--source", "camera", "--camera=1", "--no-images"],
        "pose_preprocessor": [],
        "som_classifier": [],
        "marker_tracker": ["--scene=a.yaml"],
        "action_fusion": ["--pointing-labels=point", "--pointing-labels=at"],
        "model_trainer": [],
        "web_dashboard": [],
    }


def test_a_service_understands_what_it_is_told(started: list[Program], monkeypatch: pytest.MonkeyPatch) -> None:
    up("--up-in-camera", "[0, -1, 0.2]", "--person-height-m", "1.8", "--mirrored", "--camera", "0")
    monkeypatch.setattr("sys.argv", ["sensor_gateway", *arguments_of(started)["sensor_gateway"]])
    told = from_command_line(DECLARED["sensor_gateway"], "sensor_gateway").model_dump()
    wanted = {"up_in_camera": [0, -1, 0.2], "person_height_m": 1.8, "mirrored": True, "camera": "0", "source": "camera"}
    assert {name: told[name] for name in wanted} == wanted
    up("--pointing-labels", "point", "--pointing-labels", "show", "--expected-outcomes", '{"toss": "lifted"}')
    monkeypatch.setattr("sys.argv", ["action_fusion", *arguments_of(started)["action_fusion"]])
    told = from_command_line(DECLARED["action_fusion"], "action_fusion").model_dump()
    assert told["pointing_labels"] == {"point", "show"}
    assert told["expected_outcomes"] == {"toss": "lifted"}


@pytest.mark.parametrize(
    ("service", "setting", "shown"),
    [
        ("action_fusion", "pointing_labels", "VALUE,…"),
        ("sensor_gateway", "up_in_camera", "VALUE,…"),
        ("marker_tracker", "calibrated_size_px", "VALUE,…"),
        ("action_fusion", "expected_outcomes", "NAME=VALUE,…"),
        ("marker_tracker", "objects", "JSON"),
        ("sensor_gateway", "mirrored", ""),
    ],
)
def test_a_flags_placeholder_shows_the_form_of_its_value(service: str, setting: str, shown: str) -> None:
    assert placeholder(DECLARED[service].model_fields[setting]) == shown


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--camrea", "1"), "--camera"),
        (("--scenes", "a.yaml"), "--scene"),
        (
            ("--source", "none", "--people", "2"),
            "--people is a setting of sensor_gateway, which --source none does not",
        ),
        (
            ("--people", "3"),
            "--people is a setting of sensor_gateway, which --source simulator does not",
        ),
        (("--camera", "0", "--actor", "3"), "--actor is a setting of scene_simulator, which --source camera does not"),
        (("--source", "simulator", "--camera", "1"), "--source simulator uses no camera"),
    ],
)
def test_what_nobody_would_heed_is_refused(arguments: tuple[str, ...], reason: str, started: list[Program]) -> None:
    ended = invoke("up", *arguments)
    assert ended.exit_code in (1, 2), ended.output
    assert reason in " ".join(ended.stderr.split())
    assert started == []


@pytest.mark.parametrize("source", ["none", "simulator", "camera"])
def test_what_a_further_service_heeds_is_taken_with_every_source(source: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Speaking(ServiceSettings):
        voice: str = "alto"

    monkeypatch.setattr(startup, "DECLARED", {**DECLARED, "speaker": Speaking})
    assert startup.chosen_source(source, {"voice": ["bass"]}) == source


def test_the_page_is_told_its_settings_and_can_be_left_out(started: list[Program]) -> None:
    up("--page-port", "9000", "--page-names", "lab.example")
    assert arguments_of(started)["web_dashboard"] == ["--page-port=9000", "--page-names=lab.example"]
    started.clear()
    up("--no-page")
    assert processes.PAGE not in arguments_of(started)


def test_every_setting_of_every_service_stands_in_the_help() -> None:
    shown = CliRunner().invoke(app, ["up", "--help"], env={"COLUMNS": "200"}).output
    for service, settings in DECLARED.items():
        assert f"Settings of {service}" in shown
        for name in settings.model_fields.keys() - ServiceSettings.model_fields.keys() - {*SET_BY_UP}:
            assert f"--{name.replace('_', '-')} " in shown
