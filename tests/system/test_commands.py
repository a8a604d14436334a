"""The command line, as processes."""

import re
import signal
import subprocess
from pathlib import Path
from shutil import copyfile

import pytest

from actum import keys
from actum.messages import Action, Event, Segment, Skeleton, Status
from actum.recording import Recording
from actum.runtime import Listening
from actum_command.simulated_model import SIMULATED_MODEL
from live import PATIENCE_S, System, collect, wait_until
from people import FRAME_NS, reaches
from scene_simulator.programme import Task
from scene_simulator.simulator import Simulator
from som_classifier.model_loading import load_model

pytestmark = pytest.mark.system
QUICK_DEMO = Path(__file__).parents[1] / "quick_demo.py"
SERVICES = (
    "sensor_gateway",
    "pose_preprocessor",
    "som_classifier",
    "marker_tracker",
    "action_fusion",
    "model_trainer",
)


def pids_of(system: System) -> set[int]:
    """List every process that carries this system's endpoint in its environment, whoever started it."""
    found = set()
    for environ in Path("/proc").glob("[0-9]*/environ"):
        try:
            if f"ACTUM_CONNECT={system.settings.connect}".encode() in environ.read_bytes().split(b"\0"):
                found.add(int(environ.parent.name))
        except OSError:
            continue
    return found


def assert_recognised(events: Listening) -> None:
    """Wait for an event; what was under way as a service came may be rejected before it."""
    found = collect(events, Event, lambda found: any(event.valid for event in found))
    assert [event.valid for event in found].index(True) <= 1, [event.reason for event in found]


def test_a_mark_without_a_classifier_ends_with_code_1_and_says_why(running: System) -> None:
    running.start_router()
    with running.client():
        marking = running.actum("segment", "start", "a")
    assert marking.returncode == 1
    assert "no service receives marks on actum/kinect0/segment, so the start mark was not sent" in marking.stderr


def test_watching_a_sensor_without_services_names_the_sensors_that_have_some(running: System) -> None:
    running.start_router()
    watch = running.start("actum_command", "watch", "--json", "--sensor", "nobody")
    alone = "waiting for messages of the sensor nobody, for which no service runs; "
    wait_until(lambda: f"{alone}no service of any other sensor runs either" in watch.said(), "it waits alone")
    running.start("pose_preprocessor")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        other = running.start("actum_command", "watch", "--sensor", "nobody")
        wait_until(lambda: f"{alone}services run for kinect0" in other.said(), "it names the other sensor")


def test_without_a_router_a_command_says_what_to_do(running: System) -> None:
    asked = running.actum("doctor")
    assert asked.returncode == 1
    assert "start a router with 'actum router', or set ACTUM_CONNECT" in " ".join(asked.stderr.split())


def test_marks_from_the_command_line_are_answered(running: System, scene_model: Path) -> None:
    running.start_router()
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(scene_model))
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "som_classifier")
        assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        for frame in reaches(30):
            client.put(frame)
        assert running.actum("segment", "start", "a", "--stamp-ns", "0").returncode == 0
        assert running.actum("segment", "end", "a", "--stamp-ns", str(29 * FRAME_NS)).returncode == 0
        final = collect(actions, Action, lambda found: any(action.final for action in found))[-1]
        assert (final.segment_id, final.valid, final.frames, final.missed) == ("a", True, 30, 0)


def test_up_runs_everything_that_watch_shows_restarts_what_dies_and_leaves_nothing(
    running: System, scene_model: Path
) -> None:
    up = running.start("actum_command", "up", "--model", str(scene_model), "--marked")
    with running.client() as client:
        running.wait_for_services(client, *SERVICES)
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        assert_recognised(events)
        watch = running.start("actum_command", "watch")

        def all_is_well() -> bool:
            examined = running.actum("doctor")
            return examined.returncode == 0 and "all services are there" in examined.stdout

        wait_until(all_is_well, "doctor finds nothing, once a busy machine keeps up with the sensor")
        assert "waiting for a router" not in up.said(), "the router is there first"
        wait_until(lambda: re.search(r"the page: http://127.0.0.1:\d+/", up.said()) is not None, "it names the page")
        subprocess.run(["pkill", "-KILL", "-P", str(up.process.pid), "-f", "action_fusion"], check=True)
        wait_until(lambda: "action_fusion ended with code -9 and restarts" in up.said(), "the supervisor notices")
        assert_recognised(events)
        wait_until(lambda: re.search(r"(push|pull|put|lift|point)", watch.said()) is not None, "watch prints an event")
    watch.terminate()
    up.process.send_signal(signal.SIGINT)
    assert up.process.wait(timeout=PATIENCE_S) == 0
    wait_until(lambda: pids_of(running) == set(), "no process is left")


def test_what_is_put_into_use_beside_up_never_writes_the_named_model_which_is_followed(
    running: System, scene_model: Path
) -> None:
    named, other = running.folder / "mine.npz", load_model(SIMULATED_MODEL).id
    copyfile(scene_model, named)
    (running.folder / "teaching" / "models").mkdir(parents=True)
    copyfile(SIMULATED_MODEL, running.folder / "teaching" / "models" / "other.npz")
    running.start("actum_command", "up", "--model", str(named), "--source", "none", "--no-page")
    with running.client() as client:
        running.wait_for_services(client, "som_classifier", "model_trainer")

        def classifies_by(model: str) -> None:
            wait_until(
                lambda: [info.model for info in client.infos() if info.service == "som_classifier"] == [model],
                f"the classifier uses {model}",
            )

        classifies_by(load_model(named).id)
        assert client.ask("model_trainer", "state")["model_file"] == str(named)
        client.ask("model_trainer", "activate", model=other)
        classifies_by(other)
        assert named.read_bytes() == scene_model.read_bytes()
        copyfile(scene_model, named)  # as 'actum train -o mine.npz' beside it
        classifies_by(load_model(scene_model).id)


def test_up_that_is_killed_leaves_nothing(running: System) -> None:
    up = running.start("actum_command", "up")
    with running.client() as client:
        running.wait_for_services(client, *SERVICES)
    up.process.kill()
    wait_until(lambda: pids_of(running) == set(), "no process is left")


def test_up_refuses_an_endpoint_that_a_router_has(running: System) -> None:
    running.start("actum_command", "router", "--listen", running.settings.connect)
    with running.client():
        refused = running.actum("up")
    assert refused.returncode == 1
    assert "the router cannot listen at" in refused.stderr


def test_up_refuses_a_zenoh_configuration_that_cannot_be_used(running: System, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_ZENOH_CONFIG", "/nowhere.json5")
    refused = running.actum("up")
    assert refused.returncode == 1
    assert "actum: zenoh-config: /nowhere.json5 is not a valid Zenoh configuration" in refused.stderr
    assert "Traceback" not in refused.stderr
    assert pids_of(running) == set()


def test_up_ends_with_the_complaint_of_a_service_that_cannot_be_used_as_it_is_set(running: System) -> None:
    refused = running.actum("up", "--source", "foo")
    assert refused.returncode == 1
    assert "sensor_gateway: settings: source: Input should be 'camera'" in refused.stderr
    assert "sensor_gateway did not start, because one of its settings is wrong" in refused.stderr
    assert "actum is up" not in refused.stdout
    assert pids_of(running) == set()


def test_what_is_recorded_holds_the_streams_and_the_resolved_marks(
    running: System, scene_model: Path, tmp_path: Path
) -> None:
    running.start_router()
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(scene_model))
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "som_classifier")
        file = tmp_path / "taken.mcap"
        record = running.start("actum_command", "record", str(file), "--person", "anna", "--label", "push")
        wait_until(lambda: "recording" in record.said(), "it records")
        assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        frames = reaches(40)
        for frame in frames[:5]:
            client.put(frame)
        collect(client.listen(keys.pattern(keys.STATUS, client.sensor)), Status, bool)
        client.put(Segment(sensor="kinect0", kind="start", segment_id="a"))
        collect(client.listen(keys.pattern(keys.STATUS, client.sensor)), Status, bool)
        for frame in frames[5:]:
            client.put(frame)
        collect(actions, Action, lambda found: bool(found) and found[-1].stamp_ns == frames[-1].stamp_ns)
        client.put(Segment(sensor="kinect0", kind="end", segment_id="a"))
        final = collect(actions, Action, lambda found: any(action.final for action in found))[-1]
        record.process.send_signal(signal.SIGINT)
        assert record.process.wait(timeout=PATIENCE_S) == 0
    recording = Recording(file)
    assert recording.person == "anna"
    assert sum(isinstance(m, Skeleton) for m in recording.messages((keys.SKELETON,))) == 40
    marks = [m for m in recording.messages((keys.SEGMENT,)) if isinstance(m, Segment)]
    assert [(m.kind, m.stamp_ns, m.label) for m in marks] == [
        ("start", final.start_ns, "push"),
        ("end", final.end_ns, None),
    ]


def test_what_is_done_five_times_in_the_scene_is_recorded_until_the_last_and_labelled(
    running: System, tmp_path: Path
) -> None:
    running.start_router()
    file, killed = tmp_path / "five.mcap", tmp_path / "killed.mcap"
    simulator = Simulator([Task("put", 1)] * 5, actor_seed=3, seed=3, image_hz=0, tail_s=10.0)
    with running.client() as client:
        told = ("--person", "anna", "--label", "put", "--times", "5")
        record = running.start("actum_command", "record", str(file), *told)
        other = running.start("actum_command", "record", str(killed), *told)
        for each in (record, other):
            wait_until(lambda each=each: "5 times" in each.said(), "it records")
        for number, messages in enumerate(simulator.frames()):
            client.put(messages[-1])
            if number == 600:
                other.process.kill()
        assert record.process.wait(timeout=PATIENCE_S) == 0
    assert "that was the last: stopping" in record.said()
    marks = [mark for mark in Recording(file).messages((keys.SEGMENT,)) if isinstance(mark, Segment)]
    assert [(mark.kind, mark.origin) for mark in marks] == [("start", "cut"), ("end", "cut")] * 5
    assert {mark.label for mark in marks[::2]} == {"put"}
    assert not killed.exists()


@pytest.mark.long
@pytest.mark.timeout(240)
def test_the_marked_demo_runs_to_its_table_and_leaves_nothing(
    running: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    demo = running.actum("demo", "--marked", "--people", "1", timeout_s=200)
    assert demo.returncode == 0, demo.stdout + demo.stderr
    assert re.search(r"^watch it in a browser: http://127.0.0.1:\d+/$", demo.stdout, re.M)
    assert len(re.findall(r"^ *\d+/5 ", demo.stdout, re.M)) == 5, demo.stdout
    assert re.search(r"total .*41 \(91.1%\)", demo.stdout)
    assert list((tmp_path / "temporary").iterdir()) == []
    wait_until(lambda: pids_of(running) == set(), "no process is left")


@pytest.mark.timeout(240)
@pytest.mark.long
def test_the_demo_finds_actions_that_nobody_marks_and_leaves_nothing(
    running: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    demo = running.start_script(QUICK_DEMO, "demo", "--people", "1")
    assert demo.process.wait(timeout=200) == 0, demo.said()
    assert len(re.findall(r"^ *\d/5 .*(action . *object .|not found)", demo.said(), re.M)) == 5, demo.said()
    assert re.search(r"total .*41 \(91.1%\)", demo.said())
    assert re.search(r"found by itself: [1-5] of 5 actions", demo.said())
    assert re.search(r"false alarms: \d+ in 0.5 minutes of everything else", demo.said())
    assert list((tmp_path / "temporary").iterdir()) == []
    wait_until(lambda: pids_of(running) == set(), "no process is left")


@pytest.mark.long
@pytest.mark.parametrize("way", [(), ("--marked",)])
def test_a_demo_that_is_terminated_takes_its_processes_along(running: System, way: tuple[str, ...]) -> None:
    demo = running.start_script(QUICK_DEMO, "demo", "--people", "1", *way)
    wait_until(lambda: "run as processes of their own" in demo.said(), "the processes run", patience_s=90)
    demo.process.terminate()
    assert demo.process.wait(timeout=PATIENCE_S) == 143
    wait_until(lambda: pids_of(running) == set(), "no process is left")
