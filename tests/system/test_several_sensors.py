"""One process serves several sensors: each as if it were alone, with one session and one model."""

import re
import signal
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Posture, Skeleton, Status
from actum.node import Counters
from actum.runtime import Client
from actum.runtime.serving import TAKEN
from actum_command.processes import SERVICES
from live import FEW_IMAGES_HZ, PATIENCE_S, System, collect, described, free_port, wait_until
from people import reaches
from recognisers import tiny_model
from som_classifier.model_loading import WatchedModel, load_model

pytestmark = pytest.mark.system
SENSORS = ("left", "right")
TESTS = Path(__file__).parents[1]


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


def test_up_recognises_what_is_done_before_each_sensor_with_one_process_of_each_service(running: System) -> None:
    running.variables["ACTUM_IMAGE_HZ"] = FEW_IMAGES_HZ
    up = running.start("actum_command", "up", "--sensors", ",".join(SENSORS), "--page-port", str(free_port()))
    with running.client("left") as left, running.client("right") as right:
        served: list[dict[str, set[str]]] = []
        for client in (left, right):
            running.wait_for_services(client, "sensor_gateway", "web_dashboard", "model_trainer", *SERVICES)
            events = client.listen(keys.pattern(keys.EVENT, client.sensor))
            found = collect(events, Event, lambda found: any(event.valid for event in found))
            assert {event.sensor for event in found} == {client.sensor}
            served.append({info.service: {info.instance} for info in client.infos()})
        for service in (*SERVICES, "model_trainer"):
            assert served[0][service] == served[1][service], service
        for service in ("sensor_gateway", "web_dashboard"):
            assert served[0][service] != served[1][service], service
        for sensor in SENSORS:
            assert re.search(rf"sensor {sensor}, the page: http://127.0.0.1:\d+/", up.said())
        doctor = running.actum("doctor", "--sensors", ",".join(SENSORS))
        assert "not running" not in doctor.stdout
        assert doctor.stdout.count("pose_preprocessor") >= 2
    up.process.send_signal(signal.SIGINT)
    assert up.process.wait(timeout=PATIENCE_S) == 0


def test_a_model_that_is_put_into_use_at_one_sensor_is_that_of_all(running: System, tmp_path: Path) -> None:
    running.start_router()
    models = tmp_path / "teaching" / "models"
    models.mkdir(parents=True)
    tiny_model().save(models / "taught.npz")
    running.start("model_trainer", "--sensor", ",".join(SENSORS))
    running.start("som_classifier", "--sensor", ",".join(SENSORS), "--model", str(tmp_path / "teaching" / "model.npz"))
    with running.client("left") as left, running.client("right") as right:
        for client in (left, right):
            running.wait_for_services(client, "model_trainer", "som_classifier")
            assert client.ask("model_trainer", "state")["model"] is None
        model = load_model(models / "taught.npz").id
        right.ask("model_trainer", "activate", model=model)

        def used(client: Client) -> bool:
            classifying = [info.model for info in client.infos() if info.service == "som_classifier"]
            return classifying == [client.ask("model_trainer", "state")["model"]] == [model]

        for client in (left, right):
            wait_until(lambda client=client: used(client), f"the model is in use at {client.sensor}")


@pytest.mark.parametrize("sensor", ["left", "left,right"])
@pytest.mark.parametrize("flags", [(), ("--share",)])
def test_a_bug_in_any_turn_ends_the_process_with_code_1(running: System, sensor: str, flags: tuple[str, ...]) -> None:
    running.start_router()
    service = running.start_script(TESTS / "failing_at_ticks.py", "--sensor", sensor, *flags)
    assert service.process.wait(timeout=PATIENCE_S) == 1
    assert "the third tick" in service.said()
    assert "report the bug" in service.said()


def test_nodes_that_read_one_file_share_the_model(tmp_path: Path) -> None:
    file = tmp_path / "model.npz"
    tiny_model().save(file)
    one, other = (WatchedModel(file).poll(Counters()) for _ in SENSORS)
    assert one is not None
    assert one is other
    tiny_model().save(tmp_path / "anew.npz")
    (tmp_path / "anew.npz").replace(file)
    assert WatchedModel(file).poll(Counters()) is one
