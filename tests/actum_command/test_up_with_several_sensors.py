"""`actum up --sensors left,right`: one process of each service, and a source and a page for each sensor."""

from itertools import chain

import pytest

from actum.settings import NodeSettings
from actum_command import processes
from actum_command.service_settings import TRAINER
from actum_command.supervising import Program
from command_lines import invoke, printed
from web_dashboard.server import bound_socket

SENSORS = ("--sensors", "left,right")
SHARED = (*processes.SERVICES, TRAINER)


@pytest.fixture(autouse=True)
def _sensor_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command hands its flags on in the environment, which this puts back."""
    monkeypatch.setenv("ACTUM_SENSOR", "window")


def arguments_of(started: list[Program], service: str) -> dict[str, list[str]]:
    """The flags of the processes of a service, by the sensor that each is told."""
    return {
        program.environment["ACTUM_SENSOR"]: list(program.arguments) for program in started if program.module == service
    }


@pytest.mark.parametrize("flag", ["--sensor", "--sensors"])
def test_there_is_one_process_of_each_service_and_a_scene_and_a_page_for_each_sensor(
    flag: str, started: list[Program]
) -> None:
    said = printed("up", flag, "left,right")
    assert "sensors left, right: try 'actum watch --sensor left'" in said
    own = [f"{service}-{sensor}" for service in (processes.SCENE, processes.PAGE) for sensor in ("left", "right")]
    assert [program.name for program in started] == [*SHARED, *own]
    for program in started:
        told = program.environment["ACTUM_SENSOR"]
        assert told == ("left,right" if program.name in SHARED else program.name.partition("-")[2])


def test_all_share_a_model_and_the_router_is_told_one_sensor(started: list[Program]) -> None:
    printed("up", *SENSORS)
    models = [program.environment["ACTUM_MODEL"] for program in started if "ACTUM_MODEL" in program.environment]
    assert len(models) > 1
    assert len({*models}) == 1
    both = NodeSettings(sensor="left,right")
    assert processes.router(both).environment["ACTUM_SENSOR"] == "left"


@pytest.mark.parametrize(
    ("given", "flags"),
    [
        ((), (["--seed=1"], ["--seed=2"])),
        (("--seed", "7"), (["--seed=7"], ["--seed=8"])),
        (("--seed", "7", "--seed", "3"), (["--seed=7"], ["--seed=3"])),
        (("--seed", "7", "--actor", "2"), (["--seed=7", "--actor=2"], ["--seed=8", "--actor=2"])),
        (("--seed", "7", "--actor", "2", "--actor", "4"), (["--seed=7", "--actor=2"], ["--seed=8", "--actor=4"])),
    ],
)
def test_scenes_differ_and_what_is_given_once_for_each_sensor_is_dealt_out(
    given: tuple[str, ...], flags: tuple[list[str], list[str]], started: list[Program]
) -> None:
    printed("up", *SENSORS, *given)
    told = arguments_of(started, processes.SCENE)
    assert {sensor: sorted(each) for sensor, each in told.items()} == dict(
        zip(("left", "right"), map(sorted, flags), strict=True)
    )


def test_each_sensor_has_its_camera_and_calibration_and_they_share_the_rest(started: list[Program]) -> None:
    printed("up", *SENSORS, *chain(*(("--camera", c, "--calibration", f"{c}.yaml") for c in "02")), "--people", "1")
    assert arguments_of(started, processes.GATEWAY) == {
        "left": ["--source", "camera", "--calibration=0.yaml", "--camera=0", "--people=1"],
        "right": ["--source", "camera", "--calibration=2.yaml", "--camera=2", "--people=1"],
    }
    assert [program.name for program in started if program.module == processes.GATEWAY] == [
        "sensor_gateway-left", "sensor_gateway-right",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--source", "camera"), "needs --camera 2 times, but --camera is given 0 times"),
        (("--camera", "0"), "needs --camera 2 times, but --camera is given 1 times"),
        (("--source", "recording", "--path", "a.mcap"), "--source recording for 2 sensors needs --path 2 times"),
        (("--source", "realsense"), "use --source none, and start a gateway for each sensor on a host of its own"),
    ],
)
def test_two_sensors_do_not_share_a_camera_or_a_recording(
    arguments: tuple[str, ...], reason: str, started: list[Program]
) -> None:
    ended = invoke("up", *SENSORS, *arguments)
    assert ended.exit_code == 1
    assert reason in " ".join(ended.stderr.split())
    assert started == []


def test_marks_come_from_each_scene(started: list[Program]) -> None:
    printed("up", *SENSORS, "--marked", "--no-page")
    assert [program.name for program in started][-2:] == ["scene-left", "scene-right"]


@pytest.mark.parametrize(
    ("given", "ports"),
    [
        (("--page-port", "9000"), ("9000", "9001")),
        (("--page-port", "9000", "--page-port", "9005"), ("9000", "9005")),
    ],
)
def test_pages_have_a_port_each(given: tuple[str, ...], ports: tuple[str, str], started: list[Program]) -> None:
    printed("up", *SENSORS, *given)
    assert arguments_of(started, processes.PAGE) == {
        sensor: [f"--page-port={port}"] for sensor, port in zip(("left", "right"), ports, strict=True)
    }


def test_pages_have_free_ports_in_the_order_of_the_sensors_where_none_is_named(started: list[Program]) -> None:
    with bound_socket("127.0.0.1", None) as taken:
        printed("up", *SENSORS)
        ports = [int(flag.removeprefix("--page-port=")) for [flag] in arguments_of(started, processes.PAGE).values()]
        assert ports == sorted({*ports} - {taken.getsockname()[1]})
    assert [*arguments_of(started, processes.PAGE)] == ["left", "right"]


def test_a_port_of_the_environment_is_the_first_pages(started: list[Program], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_PAGE_PORT", "9000")
    printed("up", *SENSORS)
    assert arguments_of(started, processes.PAGE) == {"left": ["--page-port=9000"], "right": ["--page-port=9001"]}


@pytest.mark.parametrize("names", ["left,", "left,,right", "Left,right"])
def test_names_that_no_sensor_can_have_are_refused(names: str, started: list[Program]) -> None:
    assert "settings: sensor: " in invoke("up", "--sensors", names).stderr
    assert started == []
