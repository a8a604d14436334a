"""One service of a kind for each sensor: whoever comes second is told, or takes over; nothing is answered twice."""

import re
import signal
from collections.abc import Sequence
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Posture
from actum.runtime import Client
from actum.runtime.serving import TAKEN
from live import PATIENCE_S, Running, System, collect, wait_until
from people import reaches
from sensors import marker_camera

SERVICES = (
    ("sensor_gateway", "scene_simulator"),
    ("pose_preprocessor", "pose_preprocessor"),
    ("som_classifier", "som_classifier"),
    ("marker_tracker", "marker_tracker"),
    ("action_fusion", "action_fusion"),
    ("model_trainer", "model_trainer"),
    ("web_dashboard", "web_dashboard"),
)
"""Each service and what is run for it: the simulated scene stands in the gateway's place."""
pytestmark = pytest.mark.system


def tokens(client: Client) -> list[str]:
    return [key.removeprefix(f"actum/{client.sensor}/alive/") for key in client.alive()]


def wait_for_tokens(client: Client, *expected: str) -> None:
    wait_until(lambda: tokens(client) == sorted(expected), f"{expected} are alive and nobody else")


def start(running: System, instance: str, *arguments: str, service: str = "pose_preprocessor") -> Running:
    return running.start(service, "--instance", instance, *arguments)


def code_of(service: Running) -> int:
    return service.process.wait(timeout=PATIENCE_S)


def assert_answered_once(client: Client) -> None:
    """Put ten skeletons; each becomes one posture, however long is waited."""
    postures = client.listen(keys.pattern(keys.POSTURE, client.sensor))
    assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
    frames = reaches(10)
    for frame in frames:
        client.put(frame)
    found = collect(postures, Posture, lambda found: len({posture.stamp_ns for posture in found}) == len(frames))
    statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
    wait_until(lambda: statuses.receive() is not None, "a second goes by")
    found += collect(postures, Posture, lambda _: True)
    assert [posture.stamp_ns for posture in found] == [frame.stamp_ns for frame in frames]


@pytest.mark.parametrize(("service", "program"), SERVICES)
def test_the_second_of_a_kind_says_so_and_ends(running: System, service: str, program: str) -> None:
    running.start_router()
    first = start(running, "one", service=program)
    with running.client() as client:
        wait_for_tokens(client, f"{service}/one")
        second = start(running, "a-second", service=program)
        assert code_of(second) == TAKEN
        [complaint] = [line for line in second.said().splitlines() if "another" in line]
        assert re.search(
            rf"another {service} already runs for sensor kinect0 \(one on \S+\), .*Stop the other.*--take-over",
            complaint,
        )
        wait_for_tokens(client, f"{service}/one")
    assert first.process.poll() is None


def test_what_a_second_would_answer_is_answered_once(running: System) -> None:
    running.start_router()
    start(running, "one")
    with running.client() as client:
        wait_for_tokens(client, "pose_preprocessor/one")
        start(running, "two")
        assert_answered_once(client)


def survivor(services: Sequence[Running]) -> Running:
    """Wait until all but one have ended, and return that one."""
    wait_until(lambda: sum(it.process.poll() is not None for it in services) == len(services) - 1, "one is left")
    [left] = [it for it in services if it.process.poll() is None]
    assert {it.process.returncode for it in services if it is not left} == {TAKEN}
    return left


def test_of_some_that_wait_for_the_same_router_one_stays(running: System) -> None:
    services = [start(running, name) for name in ("one", "two", "three")]
    wait_until(lambda: all("waiting for a router" in it.said() for it in services), "each says that it waits")
    running.start_router()
    survivor(services)
    with running.client() as client:
        wait_until(lambda: len(tokens(client)) == 1, "one is alive")
        assert_answered_once(client)


def test_of_two_of_one_name_one_stays(running: System) -> None:
    """As two containers of one host may be."""
    running.start_router()
    survivor([start(running, "one"), start(running, "one")])


def test_who_takes_over_has_the_other_stop_and_everything_is_answered_once(running: System) -> None:
    running.start_router()
    first = start(running, "one")
    with running.client() as client:
        wait_for_tokens(client, "pose_preprocessor/one")
        second = start(running, "two", "--take-over")
        assert code_of(first) == 0
        assert "two replaces this instance for sensor kinect0" in first.said()
        wait_for_tokens(client, "pose_preprocessor/two")
        assert_answered_once(client)
    assert second.process.poll() is None


def test_for_each_sensor_there_may_be_one(running: System) -> None:
    running.start_router()
    services = [start(running, "one", "--sensor", sensor) for sensor in ("left", "right")]
    for sensor in ("left", "right"):
        with running.client(sensor) as client:
            wait_for_tokens(client, "pose_preprocessor/one")
    assert [it.process.poll() for it in services] == [None, None]


@pytest.mark.parametrize("name", ["one", "two"])
def test_a_killed_one_is_replaced_at_once(running: System, name: str) -> None:
    running.start_router()
    first = start(running, "one")
    with running.client() as client:
        wait_for_tokens(client, "pose_preprocessor/one")
        first.process.kill()
        second = start(running, name)
        wait_for_tokens(client, f"pose_preprocessor/{name}")
    assert second.process.poll() is None


@pytest.mark.thorough
def test_one_that_no_longer_answers_is_waited_for_and_ends_when_it_comes_back(running: System) -> None:
    """As where the machine of the first is asleep: its token stays until Zenoh gives it up, in ten seconds."""
    running.start_router()
    first = start(running, "two")
    with running.client() as client:
        wait_for_tokens(client, "pose_preprocessor/two")
        first.process.send_signal(signal.SIGSTOP)
        second = start(running, "one")
        wait_for_tokens(client, "pose_preprocessor/one")
        assert "two, is registered but does not answer: this instance waits" in second.said()
        first.process.send_signal(signal.SIGCONT)
        assert code_of(first) == 0
        assert "one replaces this instance" in first.said()
        wait_for_tokens(client, "pose_preprocessor/one")
    assert second.process.poll() is None


def test_one_that_waits_for_its_place_can_be_stopped(running: System) -> None:
    running.start_router()
    first = start(running, "one")
    with running.client() as client:
        wait_for_tokens(client, "pose_preprocessor/one")
        first.process.send_signal(signal.SIGSTOP)
        second = start(running, "two")
        wait_until(lambda: "does not answer" in second.said(), "it waits")
        assert second.terminate() < 2.0
        assert second.process.returncode == 0
        first.process.send_signal(signal.SIGCONT)


def test_a_camera_for_the_markers_lives_beside_the_sensors_gateway(running: System, tmp_path: Path) -> None:
    running.start_router()
    gateway = start(running, "one", service="scene_simulator")
    beside = start(running, "one", *marker_camera(tmp_path), service="sensor_gateway")
    with running.client() as client:
        wait_for_tokens(client, "marker_camera/one", "sensor_gateway/one")
        third = start(running, "two", *marker_camera(tmp_path), service="sensor_gateway")
        assert code_of(third) == TAKEN
        assert "another marker_camera already runs for sensor kinect0 (one on" in third.said()
    assert [it.process.poll() for it in (gateway, beside)] == [None, None]
