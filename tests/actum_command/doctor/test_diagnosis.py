"""What `actum doctor` takes for wrong, and that it shows what services say whatever they say."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from rich.console import Console
from typer.testing import CliRunner

from actum import __version__, keys
from actum.codec import schema_name
from actum.messages import MESSAGES, Info, Message, Status
from actum.runtime import Answer, Received
from actum_command import __main__
from actum_command.commands import doctor_command
from actum_command.commands.doctor_command import show
from actum_command.doctor import heard
from actum_command.doctor.diagnosis import EXPECTED, examine
from actum_command.doctor.service_checks import Finding
from recognisers import tiny_model
from scene_simulator.endless_simulator import DESCRIPTION
from som_classifier.segmentation import CANNOT, NO_BACKGROUND, Segmentation
from som_classifier.spotting.spotted import SpottingOptions
from spotters import finding

AGAIN = "restart sensor_gateway to play the source once more, or restart sensor_gateway with"


def status(service: str, **fields: Any) -> Status:
    said: dict[str, Any] = {
        "rates": {},
        "handled": {},
        "drops": {},
        "rejects": {},
        "latency_ms": {"p50": 1.0, "p99": 2.0},
        "state": "running",
        "last_error": None,
    }
    return Status(stamp_ns=1, sensor="kinect0", service=service, instance="a", uptime_s=1.0, **(said | fields))


def info(service: str, version: str = __version__, instance: str = "a", source: str | None = None) -> Info:
    return Info(
        stamp_ns=1,
        sensor="kinect0",
        service=service,
        instance=instance,
        host="lab",
        source=source,
        version=version,
        schemas=[schema_name(message) for message in MESSAGES],
        joint_names=[],
    )


class System:
    """All services, alive and well but for what a test changes about one."""

    sensor = "kinect0"

    def __init__(self, changed: Status, version: str = __version__, source: str | None = None) -> None:
        self.also: tuple[str, str] | None = None
        self._asked_ns = 0
        self._sources = {changed.service: source}
        self._statuses: list[Message] = [status(name) for name in EXPECTED if name != changed.service]
        self._statuses.append(changed)
        self._versions = dict.fromkeys(EXPECTED, __version__) | {changed.service: version}

    def __enter__(self) -> "System":
        return self

    def __exit__(self, *_: object) -> None: ...

    def follow(self, pattern: str, take: Callable[[Received], None]) -> None:
        for message in self._statuses if "status" in pattern else []:
            take(Received(keys.key_of(message), message, None, 0))

    def members(self) -> list[str]:
        return []

    def alive(self) -> list[str]:
        names = [(name, "a") for name in EXPECTED] + ([self.also] if self.also else [])
        return sorted({f"actum/kinect0/alive/{name}/{instance}" for name, instance in names})

    def answers(self) -> list[Answer]:
        found = [info(name, version, source=self._sources.get(name)) for name, version in self._versions.items()]
        found += [info(self.also[0], instance=self.also[1])] if self.also else []
        self._asked_ns += 1
        return [Answer(each, self._asked_ns, self._asked_ns + 2, came_ns=2) for each in found]


@pytest.fixture(autouse=True)
def _brief(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heard, "STATUS_S", 0.05)


def examined(**fields: Any) -> Finding:
    found_by = examine(System(status("som_classifier", **fields))).findings  # type: ignore[arg-type]
    [found] = [each for each in found_by if each.service == "som_classifier"]
    return found


def diagnosed(monkeypatch: pytest.MonkeyPatch, system: System) -> tuple[int, str]:
    monkeypatch.setattr(doctor_command, "connect", lambda here: system)
    ended = CliRunner().invoke(__main__.app, ["doctor"])
    return ended.exit_code, ended.output


def test_each_of_several_sensors_is_checked_and_a_problem_of_one_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    systems = {"left": System(status("som_classifier")), "right": System(status("som_classifier"), version="0.0.1")}
    monkeypatch.setattr(doctor_command, "connect", lambda here: systems[here.sensor])
    monkeypatch.setenv("ACTUM_SENSOR", "window")
    ended = CliRunner().invoke(__main__.app, ["doctor", "--sensors", "left,right"])
    _, left, right = re.split("^sensor (?:left|right)$", ended.output, flags=re.MULTILINE)
    assert ended.exit_code == 1
    assert "som_classifier" in left and "som_classifier is version" not in left
    assert "som_classifier is version 0.0.1" in right and "all services are there" not in right


def test_a_system_that_is_well_is_said_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    code, output = diagnosed(monkeypatch, System(status("som_classifier")))
    assert code == 0
    assert "all services are there, alive and of one version" in output
    assert "dropped" not in output


class FromRos(System):
    """A system whose skeletons come from a bridge that reads bodies; the gateway runs beside it if that is wanted."""

    def __init__(self, gateway: bool) -> None:
        super().__init__(status("ros2_bridge"), source="ROS 2, bodies of ROS4HRI in the frame camera")
        self._has_gateway = gateway
        if not gateway:
            self._statuses = [it for it in self._statuses if getattr(it, "service", "") != "sensor_gateway"]
            del self._versions["sensor_gateway"]
        self.also = ("ros2_bridge", "a")

    def alive(self) -> list[str]:
        return [token for token in super().alive() if self._has_gateway or "sensor_gateway" not in token]

    def answers(self) -> list[Answer]:
        return list({answer.info.service: answer for answer in reversed(super().answers())}.values())


def test_a_bridge_that_reads_bodies_replaces_the_gateway(monkeypatch: pytest.MonkeyPatch) -> None:
    code, output = diagnosed(monkeypatch, FromRos(gateway=False))
    assert code == 0, output
    assert "sensor_gateway" not in output
    assert "sensor: ROS 2, bodies of ROS4HRI in the frame camera" in output


def test_a_gateway_beside_a_bridge_that_reads_bodies_is_a_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    code, output = diagnosed(monkeypatch, FromRos(gateway=True))
    assert code == 1
    assert "both sensor_gateway and ros2_bridge publish this sensor's skeletons" in output.replace("\n", " ")


def test_another_version_is_a_problem_though_it_has_the_same_schemas(monkeypatch: pytest.MonkeyPatch) -> None:
    code, output = diagnosed(monkeypatch, System(status("som_classifier"), version="0.0.1"))
    assert code == 1
    assert f"som_classifier is version 0.0.1, but this program is version {__version__}" in output
    assert "of one version" not in output


@pytest.mark.parametrize(
    ("latency_ms", "shown"),
    [({}, ""), ({"p50": 1.5}, "1.50 / -"), ({"mean": 3.0}, "- / -"), ({"p50": 1.5, "p99": 2.0}, "1.50 / 2.00")],
)
def test_a_latency_that_is_not_told_is_a_dash(latency_ms: dict[str, float], shown: str) -> None:
    assert examined(latency_ms=latency_ms).latency == shown


@pytest.mark.parametrize(
    ("state", "told"),
    [
        ("source ended", ": restart som_classifier to play"),
        ("camera lost: it does not answer", " and keeps trying"),
        ("no model: there is no m.npz yet", " and therefore recognises no action: set --model"),
        ("model not renewed: m.npz: damaged", " and still uses the previous model, because"),
    ],
)
def test_a_state_in_which_nothing_is_answered_is_a_problem(state: str, told: str) -> None:
    [problem] = examined(state=state).problems
    assert problem.startswith(f"som_classifier has the state '{state}'{told}")


@pytest.mark.parametrize(
    ("state", "source", "told"),
    [
        ("camera lost: it cannot be opened", "file wave.mp4 (camera)", " and keeps trying"),
        (
            "source ended",
            "file wave.mp4 (camera)",
            f": {AGAIN} --loop to repeat the source without end",
        ),
        (
            "source ended",
            DESCRIPTION,
            f": {AGAIN} --repetitions 0 to repeat the source without end",
        ),
    ],
)
def test_a_gateway_that_gives_nothing_is_told_with_what_it_reads(state: str, source: str, told: str) -> None:
    gateway = System(status("sensor_gateway", state=state), source=source)
    [problem] = [p for finding in examine(gateway).findings for p in finding.problems]  # type: ignore[arg-type]
    assert problem.startswith(f"sensor_gateway has the state '{state}' ({source}){told}")


class Sensorless(System):
    def alive(self) -> list[str]:
        return [key for key in super().alive() if "sensor_gateway" not in key]

    def follow(self, pattern: str, take: Callable[[Received], None]) -> None:
        self._statuses = [each for each in self._statuses if getattr(each, "service", "") != "sensor_gateway"]
        super().follow(pattern, take)


def test_where_there_is_no_sensor_both_programs_that_can_be_one_are_named() -> None:
    [problem] = [p for finding in examine(Sensorless(status("som_classifier"))).findings for p in finding.problems]  # type: ignore[arg-type]
    assert problem.startswith("sensor_gateway is not running: start it with 'python -m sensor_gateway'")
    assert "for the simulated scene 'python -m scene_simulator'" in problem


def test_a_simulated_sensor_is_said_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    code, output = diagnosed(monkeypatch, System(status("sensor_gateway"), source="simulated scene [a]"))
    assert code == 0
    assert "sensor: simulated scene [a]" in output


@pytest.mark.parametrize("second", ["b", "a"])
def test_two_of_one_identity_are_a_problem_that_names_both(monkeypatch: pytest.MonkeyPatch, second: str) -> None:
    """Two of the same name share a token, but each describes itself."""
    system = System(status("pose_preprocessor"))
    system.also = ("pose_preprocessor", second)
    code, output = diagnosed(monkeypatch, system)
    assert code == 1
    assert (
        f"more than one instance of pose_preprocessor runs (a on lab, {second} on lab), so every result is published "
        "more than once: stop all instances but one"
    ) in output


def test_where_there_is_no_room_for_a_table_there_are_lines_of_whole_words() -> None:
    console = Console(width=60)
    with console.capture() as capture:
        show(examine(System(status("som_classifier", drops={"actum/kinect0/skeleton": 3}))).findings, console)  # type: ignore[arg-type]
    lines = capture.get().splitlines()
    assert "som_classifier, 1 alive" in lines
    assert "  dropped: skeleton 3" in lines
    assert "  latency p50/p99 (ms): 1.00 / 2.00" in lines
    assert "pose_preprocessor, 1 alive" in lines


def test_what_a_model_cannot_is_told_and_is_no_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    """The states are those of the classifier, so that they are known again."""
    for note in (CANNOT, NO_BACKGROUND):
        code, output = diagnosed(monkeypatch, System(status("som_classifier", state=f"running; {note}")))
        assert code == 0
        assert f"som_classifier: {note}\n" in output


def test_settings_that_have_no_effect_are_a_problem() -> None:
    model, wrong = tiny_model(), SpottingOptions(disabled=frozenset({"wvae"}))
    searching = Segmentation(options=wrong).state(finding(model))
    for state in (Segmentation("auto").state(model), searching):
        assert examined(state=state).problems == (f"som_classifier: {state}",)


def test_what_was_found_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    assert examined(counts={"found": 3, "told": 2}).counts == "found 3, told 2"
    _, output = diagnosed(monkeypatch, System(status("som_classifier")))
    assert "counted" not in output


def test_marks_that_are_not_used_are_told() -> None:
    (remark,) = examined(counts={"marks_ignored": 4}).remarks
    assert remark == (
        "som_classifier has rejected 4 start and end marks of actions, because its setting 'segments' was 'auto': "
        "to accept marks, set 'segments' to 'both' on the page under Parameters, or start with --segments both"
    )


def test_beside_the_page_which_reads_everything_the_table_stays_readable() -> None:
    """A hundred characters wide: what people and services have in common is one rate, and no word is broken."""
    leaves = [
        "skeleton",
        "image/color",
        "objects",
        "truth",
        "segment",
        "training",
        *(f"status/{name}" for name in EXPECTED),
    ]
    leaves += [f"{topic}/{agent}" for topic in ("posture", "action", "event") for agent in range(1, 5)]
    silent = {"actum/kinect0/segment": 0.0, "actum/kinect0/truth": 0.0}
    page = status("web_dashboard", rates={f"actum/kinect0/{leaf}": 29.97 for leaf in leaves} | silent)
    system = System(page)
    system.also = ("web_dashboard", "a")
    console = Console(width=100)
    with console.capture() as capture:
        show(examine(system).findings, console)  # type: ignore[arg-type]
    lines = capture.get().splitlines()
    assert all(line[-1] in "┓┃┩│┘" for line in lines), "nothing is cut off"
    [first] = [number for number, line in enumerate(lines) if "web_dashboard" in line]
    assert len(lines) - first <= 6, "some lines and the table's last"
    shown = " ".join(line.split("│")[5].strip() for line in lines[first:] if "│" in line)
    assert shown == (
        "skeleton 30, image/color 30, objects 30, training 30, status 150, posture 120, action 120, event 120"
    )
