"""Two compose projects, each with networks and a router of its own, which share the routers' link through a proxy."""

import json
import os
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
from benchmarks.rig.tcp_proxy import TcpProxy

from actum import keys
from actum.messages import Event
from actum.runtime import Client
from actum.settings import ServiceSettings
from compose_files import DEPLOY, gateway_of_bridge
from live import collect, free_endpoint, wait_until
from marked_scene import ACTIONS, SCENE, SCENE_S, Told, mark, on_one_host, told

HEALTHY_S = 120
IMAGES = "actum/*/image/**"
COMPUTE = ("router", "pose_preprocessor", "som_classifier", "action_fusion", "web_dashboard")
pytestmark = pytest.mark.containers


def docker(*arguments: str) -> str:
    return subprocess.run(["docker", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


@dataclass
class Host:
    """A compose project, and the port of this machine on which its router is published."""

    name: str
    file: str
    environment: dict[str, str]
    port: int

    def compose(self, *arguments: str) -> str:
        command = ["docker", "compose", "--project-name", self.name, *self.file.split(), *arguments]
        return subprocess.run(
            command, env={**os.environ, **self.environment}, check=True, stdout=subprocess.PIPE, text=True
        ).stdout

    def up(self, *services: str) -> None:
        self.compose("up", "--build", "--detach", "--wait", "--wait-timeout", str(HEALTHY_S), *services)

    @contextmanager
    def client(self) -> Iterator[Client]:
        with Client(ServiceSettings(connect=f"tcp/127.0.0.1:{self.port}"), wait_s=HEALTHY_S) as client:
            yield client


@dataclass
class Hosts:
    """The sensor's host, the one that computes, and the link."""

    sensor: Host
    compute: Host
    link: TcpProxy


@pytest.fixture(scope="module")
def hosts(tmp_path_factory: pytest.TempPathFactory, scene_model: Path) -> Iterator[Hosts]:
    """Both hosts with all but the scene running; gone afterwards."""
    folder = tmp_path_factory.mktemp("hosts")
    (folder / "models").mkdir()
    (folder / "models" / "model.npz").write_bytes(scene_model.read_bytes())
    scene = folder / "scene.yml"
    settings = {f"ACTUM_{name.upper()}": str(value) for name, value in SCENE.items()}
    scene.write_text(json.dumps({"services": {"scene_simulator": {"environment": settings}}}))
    ports = [int(free_endpoint().rpartition(":")[2]) for _ in range(3)]
    sensor_file = f"-f {DEPLOY}/compose.kinect-host.yml -f {scene}"
    sensor = Host("actum-sensor-test", sensor_file, {"ACTUM_ROUTER_PORT": str(ports[0])}, ports[0])
    gateway = gateway_of_bridge()
    with TcpProxy(sensor.port, host=gateway, seed=1) as link:
        environment = {
            "ACTUM_CONNECT": f"tcp/{gateway}:{link.port}",
            "ACTUM_MODELS": str(folder / "models"),
            "ACTUM_ROUTER_PORT": str(ports[1]),
            "ACTUM_PAGE_PORT": str(ports[2]),
        }
        compute = Host("actum-compute-test", f"-f {DEPLOY}/compose.compute-host.yml", environment, ports[1])
        try:
            sensor.up("router", "marker_tracker")
            compute.up(*COMPUTE)
            yield Hosts(sensor, compute, link)
        finally:
            for host in (sensor, compute):
                host.compose("down", "--volumes")


def play(hosts: Hosts, prefix: str, disturb: Callable[[TcpProxy, threading.Event], None]) -> Told:
    """Run the scene once, mark it on the sensor's host while the link is disturbed; return what the other tells."""
    over = threading.Event()
    with hosts.sensor.client() as switch, hosts.compute.client() as reader:
        events = reader.listen(keys.pattern(keys.EVENT, reader.sensor))
        truths = switch.listen(keys.key(keys.TRUTH, switch.sensor))
        assert switch.wait_for_subscriber(keys.SEGMENT, SCENE_S)
        threads = [
            threading.Thread(target=mark, args=(switch, truths, prefix, over)),
            threading.Thread(target=disturb, args=(hosts.link, over)),
        ]
        for thread in threads:
            thread.start()
        try:
            hosts.sensor.compose("up", "--build", "--detach", "--force-recreate", "scene_simulator")
            return told(collect(events, Event, lambda found: len(told(found, prefix)) >= ACTIONS, SCENE_S), prefix)
        finally:
            over.set()
            for thread in threads:
                thread.join()
            hosts.link.delay(0.0)
            hosts.link.mend()
            hosts.sensor.compose("stop", "scene_simulator")


def undisturbed(link: TcpProxy, over: threading.Event) -> None:
    """A cable as it should be."""


def delayed(link: TcpProxy, over: threading.Event) -> None:
    """A slow radio link."""
    link.delay(0.25, 0.2)


def stalling(link: TcpProxy, over: threading.Event) -> None:
    """A switch that lets nothing pass, again and again."""
    while not over.wait(3.0):
        link.stall(1.0)
        over.wait(1.0)


def cut_now_and_then(link: TcpProxy, over: threading.Event) -> None:
    """A loose plug."""
    while not over.wait(6.0):
        link.cut()
        over.wait(1.0)
        link.mend()


@pytest.mark.timeout(900)
@pytest.mark.parametrize("disturb", [undisturbed, delayed, stalling, cut_now_and_then])
def test_two_hosts_tell_what_one_tells(hosts, scene_model, disturb):
    expected = on_one_host(scene_model)
    assert len(expected) == ACTIONS
    assert play(hosts, f"{disturb.__name__}-", disturb) == expected


@pytest.mark.timeout(900)
def test_images_stay_on_the_sensors_host(hosts):
    crossed: list[str] = []
    image_bytes: list[int] = []
    with hosts.sensor.client() as near, hosts.compute.client() as far:
        near.tap(IMAGES, lambda sample: image_bytes.append(len(sample.payload)))
        far.tap("actum/**", lambda sample: crossed.append(str(sample.key_expr)))
        before = sum(hosts.link.carried_bytes)
        hosts.sensor.compose("up", "--build", "--detach", "--force-recreate", "scene_simulator")
        wait_until(lambda: len(image_bytes) >= 150, "ten seconds of images on the sensor's host", patience_s=60)
        carried = sum(hosts.link.carried_bytes) - before
    hosts.sensor.compose("stop", "scene_simulator")
    print(f"{sum(image_bytes) / 1e6:.1f} MB of images, {carried / 1e6:.1f} MB over the link")
    assert keys.key(keys.SKELETON, "kinect0") in crossed
    assert not [key for key in crossed if "/image/" in key]
    assert carried < 0.5 * sum(image_bytes)


@pytest.mark.timeout(900)
def test_the_hosts_share_no_network_and_nobody_is_root(hosts):
    networks: list[set[str]] = []
    for host in (hosts.sensor, hosts.compute):
        found = [json.loads(docker("inspect", one))[0] for one in host.compose("ps", "--quiet").split()]
        networks.append({network for one in found for network in one["NetworkSettings"]["Networks"]})
        assert {one["HostConfig"]["ReadonlyRootfs"] for one in found} == {True}
        assert {docker("exec", one["Id"], "id", "-u") for one in found} == {"10001\n"}
    assert len(networks[0]) == len(networks[1]) == 1
    assert not networks[0] & networks[1]
