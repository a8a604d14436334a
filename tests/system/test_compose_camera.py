"""The camera host's compose file: what it says, and a person seen by it on a real engine."""

import json
import os
import subprocess
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import msgpack
import pytest
import zenoh

from compose_files import DEPLOY, services_of
from live import wait_until

FILE = DEPLOY / "compose.camera-host.yml"
SERVICES = ("router", "sensor_gateway", "marker_tracker")


@pytest.fixture(scope="module")
def services() -> dict[str, dict[str, Any]]:
    return services_of(FILE)


def test_the_host_runs_router_gateway_and_tracker(services):
    assert tuple(services) == SERVICES
    extends = {name: service.get("extends") for name, service in services.items()}
    shared = {name: {"file": "../docker-compose.yml", "service": name} for name in ("router", "marker_tracker")}
    assert extends == shared | {"sensor_gateway": None}  # one host has a simulated scene in its place
    assert services["sensor_gateway"]["init"]
    assert services["sensor_gateway"]["restart"] == "unless-stopped"


@pytest.mark.parametrize(
    ("name", "told"),
    [("sensor_gateway", {"source", "camera", "pose_model", "calibration"}), ("marker_tracker", {"objects", "scene"})],
)
def test_every_variable_is_a_setting_of_its_service(name, told, services):
    known = import_module(f"{name}.settings").Settings.model_fields
    variables = {variable.removeprefix("ACTUM_").lower() for variable in services[name]["environment"]}
    assert told <= variables <= set(known)


def resolved(environment: dict[str, str]) -> dict[str, dict[str, Any]]:
    told = compose("config", "--format", "json", environment={"ACTUM_POSE_MODEL": "/pose.task", **environment})
    return json.loads(told)["services"]


def mounted(service: dict[str, Any]) -> dict[str, str]:
    return {volume["target"]: volume["source"] for volume in service["volumes"]}


@pytest.mark.containers
@pytest.mark.parametrize(
    ("name", "variable"), [("sensor_gateway", "ACTUM_CALIBRATION"), ("marker_tracker", "ACTUM_SCENE")]
)
def test_a_file_of_the_hosts_stands_where_the_service_looks_for_it(name, variable):
    service = resolved({variable: "/home/anna/file.yaml"})[name]
    assert mounted(service)[service["environment"][variable]] == "/home/anna/file.yaml"
    assert resolved({})[name]["environment"].get(variable) is None


@pytest.mark.containers
def test_no_real_marker_is_taken_for_an_object_of_the_simulated_scene():
    assert resolved({})["marker_tracker"]["environment"].get("ACTUM_OBJECTS") is None


def compose(*arguments: str, environment: dict[str, str]) -> str:
    command = ["docker", "compose", "--project-name", "actum-camera-test", "--file", str(FILE), *arguments]
    return subprocess.run(
        command, env={**os.environ, **environment}, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


@pytest.fixture
def host(data: Path) -> Iterator[dict[str, str]]:
    """The environment of a host whose camera is a video file; its containers are gone afterwards."""
    environment = {
        "ACTUM_POSE_MODEL": os.environ["ACTUM_POSE_MODEL"],
        "ACTUM_VIDEOS": str(data / "people_video"),
        "ACTUM_CAMERA": "/videos/exercise.avi",
        "ACTUM_CAMERA_DEVICE": "/dev/null",
        "ACTUM_PEOPLE": "1",
    }
    try:
        compose("up", "--build", "--detach", environment=environment)
        yield environment
    finally:
        compose("down", "--volumes", environment=environment)


def messages(session: zenoh.Session, key: str, n: int) -> list[dict[str, Any]]:
    """The next n messages on a key that hold somebody or something."""
    found: list[dict[str, Any]] = []
    subscriber = session.declare_subscriber(key, zenoh.handlers.FifoChannel(256))

    def enough() -> bool:
        while (sample := subscriber.try_recv()) is not None:
            message = msgpack.unpackb(sample.payload.to_bytes())
            found.extend([message] if message.get("agents") or message.get("data") else [])
        return len(found) >= n

    wait_until(enough, f"{n} messages on {key}", patience_s=60)
    return found


@pytest.mark.containers
@pytest.mark.data
@pytest.mark.pose_model
@pytest.mark.timeout(1200)
def test_up_sees_a_person_in_a_video_file_and_down_leaves_nothing(host):
    compose("up", "--detach", "--wait", "--wait-timeout", "120", *SERVICES, environment=host)
    print(compose("ps", "--format", "table {{.Service}}\t{{.Status}}", environment=host))
    assert compose("exec", "-T", "sensor_gateway", "id", "-u", environment=host).strip() == "10001"
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", '["tcp/127.0.0.1:7447"]')
    with zenoh.open(config) as session:
        compose("restart", "sensor_gateway", environment=host)
        skeletons = messages(session, "actum/kinect0/skeleton", 20)
        [image, *_] = messages(session, "actum/kinect0/image/color", 1)
    assert all(len(skeleton["agents"][0]["joints"]) == 15 for skeleton in skeletons)
    assert (image["width"], image["height"], image["intrinsics_assumed"]) == (384, 288, True)
    compose("down", environment=host)
    assert compose("ps", "--all", "--quiet", environment=host) == ""
