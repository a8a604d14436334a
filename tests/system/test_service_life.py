"""Each service alone: it waits for the router, serves, and leaves cleanly."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import msgpack
import pytest

from actum import codec, keys
from actum.messages import Posture, Status
from actum.runtime import Client
from actum.runtime.outbox import MOST_PUBLISHERS
from live import ROUTER, Running, System, collect, described, wait_until
from people import STANDING, reaches, skeleton

PROGRAMS = {
    "sensor_gateway": "scene_simulator",
    "pose_preprocessor": "pose_preprocessor",
    "som_classifier": "som_classifier",
    "marker_tracker": "marker_tracker",
    "action_fusion": "action_fusion",
    "web_dashboard": "web_dashboard",
    **({"ros2_bridge": "ros2_bridge"} if find_spec("rosbags") else {}),
}
"""What is run for each service: the simulated scene stands in the gateway's place."""
pytestmark = pytest.mark.system


@pytest.fixture
def waiting(running: System) -> dict[str, Running]:
    """Every service, started without a router, each with a sensor of its own."""
    services = {name: running.start(program, "--sensor", name) for name, program in PROGRAMS.items()}
    wait_until(lambda: all("waiting for a router" in it.said() for it in services.values()), "each says that it waits")
    return services


def assert_leave_cleanly(services: dict[str, Running]) -> None:
    for name, service in services.items():
        assert service.terminate() < 2.0, name
        assert service.process.returncode == 0, name


def test_services_started_before_the_router_wait_for_it_serve_and_leave(
    running: System, waiting: dict[str, Running]
) -> None:
    running.start_router()
    for name in PROGRAMS:
        with running.client(sensor=name) as client:
            running.wait_for_services(client, name)
            status = collect(client.listen(keys.pattern(keys.STATUS, client.sensor)), Status, bool)[0]
            assert (status.service, status.valid, status.rejects) == (name, True, {})
            info = described(client)
            assert "actum.skeleton/1" in info.schemas
            assert info.joint_names[0] == "head"
    assert_leave_cleanly(waiting)
    assert {name: it.said().count("waiting for a router") for name, it in waiting.items()} == dict.fromkeys(PROGRAMS, 1)


def test_services_that_never_found_their_router_leave_cleanly_too(waiting: dict[str, Running]) -> None:
    assert_leave_cleanly(waiting)


def test_a_service_survives_its_routers_death(running: System) -> None:
    router = running.start_router_process()
    preprocessor = running.start("pose_preprocessor")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        router.process.kill()
        router.process.wait()
        running.start_router_process()
        wait_until(client.connected, "the session has its router again")
        postures = client.listen(keys.pattern(keys.POSTURE, client.sensor))
        running.wait_for_services(client, "pose_preprocessor")
        assert client.wait_for_subscriber(keys.SKELETON, 10.0)
        client.put(skeleton(1, STANDING))
        assert collect(postures, Posture, bool)[0].valid
    assert preprocessor.process.poll() is None


@pytest.fixture
def preprocessor_client(running: System) -> Iterator[Client]:
    """A client of a system that runs a preprocessor."""
    running.start_router()
    running.start("pose_preprocessor")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor")
        assert client.wait_for_subscriber(keys.SKELETON, 10.0)
        yield client


def test_bad_payloads_are_counted_in_status_and_survived(preprocessor_client: Client) -> None:
    client = preprocessor_client
    statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
    postures = client.listen(keys.pattern(keys.POSTURE, client.sensor))
    key = keys.key(keys.SKELETON, client.sensor)
    good = codec.encode(skeleton(1, STANDING))
    client.put_raw(key, b"\xc1 no msgpack")
    client.put_raw(key, msgpack.packb([1, 2, 3]))
    client.put_raw(key, msgpack.packb({"stamp_ns": "soon", "agents": []}))
    client.put_raw(key, good.payload, "application/msgpack;actum.skeleton/9")
    client.put_raw(key, bytes(2 * keys.SKELETON.max_bytes))
    client.put_raw(key, good.payload, good.encoding)
    assert collect(postures, Posture, bool)[0].stamp_ns == 1
    expected = {"not_msgpack": 1, "not_a_map": 1, "wrong_fields": 1, "higher_version": 1, "too_large": 1}
    last = collect(statuses, Status, lambda found: bool(found) and found[-1].rejects == expected)[-1]
    assert last.last_error is not None


def test_agents_without_end_are_published_and_publishers_are_not_kept(preprocessor_client: Client) -> None:
    postures = preprocessor_client.listen(keys.pattern(keys.POSTURE, preprocessor_client.sensor))
    for agent in range(1, MOST_PUBLISHERS + 50):
        [one] = skeleton(agent, STANDING).agents
        frame = skeleton(agent).model_copy(update={"agents": [one.model_copy(update={"agent": agent})]})
        preprocessor_client.put(frame)
        assert [p.agent for p in collect(postures, Posture, bool)] == [agent]


def test_numbers_that_are_missing_are_reported_as_drops(preprocessor_client: Client) -> None:
    client = preprocessor_client
    statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
    for frame in reaches(10):
        if frame.seq not in (3, 4, 5):
            client.put(frame)
    key = keys.key(keys.SKELETON, client.sensor)
    collect(statuses, Status, lambda found: bool(found) and found[-1].drops == {key: 3})


def test_tokens_go_with_their_process(running: System) -> None:
    running.start_router()
    service = running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        service.process.kill()
        wait_until(lambda: client.alive() == [], "the token is gone")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["sensor_gateway"], "set --source (ACTUM_SOURCE)"),
        (["sensor_gateway", "--source", "recording"], "needs --path"),
        (["sensor_gateway", "--source", "recording", "--path", "/nowhere"], "/nowhere"),
        (["sensor_gateway", "--source", "camera", "--pose-model", "/nowhere"], "'actum models fetch'"),
        (["marker_tracker", "--dictionary", "DICT_NONE"], "dictionary: "),
        (["pose_preprocessor", "--sensor", "Kinect 0"], "sensor: "),
        (["pose_preprocessor", "--connect", "127.0.0.1:7551"], "'127.0.0.1:7551' is not an endpoint: use tcp/"),
        (["scene_simulator", "--connect", "foo"], "'foo' is not an endpoint: use tcp/host:port"),
        (["action_fusion", "--zenoh-config", "/nowhere.json5"], "/nowhere.json5 is not a valid Zenoh configuration"),
        (["action_fusion", "--state", __file__], f"state: the folder {__file__} cannot be created"),
        (["action_fusion", "--zenoh-config", __file__], f"{__file__} is not a valid Zenoh configuration"),
    ],
)
def test_settings_that_cannot_be_used_end_with_one_line(running: System, arguments: list[str], complaint: str) -> None:
    service = running.start(*arguments)
    assert service.process.wait(timeout=30) == 2
    assert service.said().startswith(f"{arguments[0]}: ")
    assert complaint in service.said()
    assert service.said().count("\n") == 1


def test_a_configuration_file_that_is_not_there_is_no_defaults(
    running: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ACTUM_CONFIG", "/nowhere.toml")
    service = running.start("pose_preprocessor")
    assert service.process.wait(timeout=30) == 2
    named = "ACTUM_CONFIG names /nowhere.toml, which does not exist or is not a file: correct or unset ACTUM_CONFIG"
    assert service.said() == f"pose_preprocessor: {named}\n"


def test_a_service_goes_on_where_its_health_file_cannot_be_written(running: System) -> None:
    running.start_router()
    service = running.start("pose_preprocessor", "--health-file", "/nowhere/health")
    with running.client() as client:
        statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
        assert len(collect(statuses, Status, lambda found: len(found) == 3)) == 3
    assert service.said().count("the health file cannot be written") == 1


@pytest.mark.parametrize(
    ("bug", "where"),
    [("status", "in the thread kinect0 reporting"), ("thread", "in the thread own"), ("info", "describing")],
)
def test_a_service_of_which_a_part_has_a_bug_ends_and_says_so_instead_of_going_on_mute(
    running: System, bug: str, where: str
) -> None:
    running.start_router()
    service = running.start_script(Path(__file__).parents[1] / "mute_service.py", bug)
    with running.client() as client:

        def ended() -> bool:
            client.infos()
            return service.process.poll() is not None

        wait_until(ended, "the process ends", 15.0)
    assert service.process.returncode == 1
    assert "a bug occurred" in service.said() and where in service.said()


def test_a_router_goes_on_where_its_health_file_cannot_be_written(running: System) -> None:
    program = ROUTER.replace("stop_on_signals())", "stop_on_signals(), health_file=Path('/nowhere/health'))")
    router = running._start(
        "router", "-c", "import logging\nlogging.basicConfig()\n" + program, running.settings.connect
    )
    with running.client() as client:
        wait_until(lambda: "the health file cannot be written" in router.said(), "it says so")
        assert client.connected() and router.process.poll() is None
