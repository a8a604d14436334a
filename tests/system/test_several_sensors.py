"""One process serves several sensors: each as if it were alone, with one session and one model."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import Posture, Skeleton, Status
from actum.node import Counters
from actum.runtime import Client
from actum.runtime.serving import TAKEN
from live import PATIENCE_S, System, collect, described, wait_until
from people import reaches
from recognisers import tiny_model
from som_classifier.model_loading import WatchedModel

pytestmark = pytest.mark.system
SENSORS = ("left", "right")


def frames(sensor: str) -> list[Skeleton]:
    return [frame.model_copy(update={"sensor": sensor}) for frame in reaches(10)]


def answered(client: Client) -> list[int]:
    """Put ten skeletons of this sensor, and return the stamps of its postures."""
    postures = client.listen(keys.pattern(keys.POSTURE, client.sensor))
    assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
    put = frames(client.sensor)
    for frame in put:
        client.put(frame)
    return [each.stamp_ns for each in collect(postures, Posture, lambda found: len(found) == len(put))]


def test_each_sensor_gets_its_own_answers_status_and_description(running: System, tmp_path: Path) -> None:
    running.start_router()
    health = tmp_path / "health"
    service = running.start("pose_preprocessor", "--sensor", ",".join(SENSORS), "--health-file", str(health))
    for sensor in SENSORS:
        with running.client(sensor) as client:
            assert answered(client) == [frame.stamp_ns for frame in frames(sensor)]
            status = collect(client.listen(keys.pattern(keys.STATUS, sensor)), Status, bool)[0]
            assert sum(status.handled.values()) == 10
            assert described(client).sensor == sensor
    wait_until(health.exists, "the health file is written")
    assert service.terminate() < 2.0
    assert service.process.returncode == 0


def test_a_sensor_that_another_serves_is_refused_and_a_successor_takes_over_its_sensor_alone(running: System) -> None:
    running.start_router()
    both = running.start("pose_preprocessor", "--sensor", ",".join(SENSORS), "--instance", "both")
    with running.client("left") as left, running.client("right") as right:
        for client in (left, right):
            running.wait_for_services(client, "pose_preprocessor")
        second = running.start("pose_preprocessor", "--sensor", "other,right", "--instance", "second")
        assert second.process.wait(timeout=PATIENCE_S) == TAKEN
        assert "already runs for sensor right" in second.said()
        running.start("pose_preprocessor", "--sensor", "right", "--instance", "successor", "--take-over")
        wait_until(lambda: [key.split("/")[-1] for key in right.alive()] == ["successor"], "the successor serves right")
        assert "right: the instance successor replaces this instance" in both.said()
        assert [key.split("/")[-1] for key in left.alive()] == ["both"]
        assert answered(left) == [frame.stamp_ns for frame in frames("left")]


def test_nodes_that_read_one_file_share_the_model(tmp_path: Path) -> None:
    file = tmp_path / "model.npz"
    tiny_model().save(file)
    one, other = (WatchedModel(file).poll(Counters()) for _ in SENSORS)
    assert one is not None
    assert one is other
    tiny_model().save(tmp_path / "anew.npz")
    (tmp_path / "anew.npz").replace(file)
    assert WatchedModel(file).poll(Counters()) is one
