"""What `actum deploy init` writes, taken up by Compose as it is: a camera's host and one that computes, both locked."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from benchmarks.rig.tcp_proxy import TcpProxy

from actum import keys
from actum.messages import Event
from actum.runtime import Client
from actum.settings import ServiceSettings
from compose_files import MAIN, gateway_of_bridge
from live import collect, free_endpoint, wait_until
from marked_scene import ACTIONS, SCENE, SCENE_S, mark, on_one_host, told

HEALTHY_S = 120
pytestmark = [
    pytest.mark.containers,
    pytest.mark.timeout(900),
    pytest.mark.skipif(os.geteuid() != 0, reason="keys are handed to the containers' user by root alone"),
]


def docker(*arguments: str) -> str:
    return subprocess.run(["docker", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def actum(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "actum_command", *arguments], check=True)


@dataclass
class Taken:
    """The deployment's folder, the address of both hosts, each host's port, and the link between their routers."""

    folder: Path
    address: str
    ports: dict[str, int]
    link: TcpProxy

    def compose(self, host: str, *arguments: str) -> str:
        return docker("compose", "--project-directory", str(self.folder / host), *arguments)

    def up(self, host: str) -> None:
        self.compose(host, "up", "--detach", "--wait", "--wait-timeout", str(HEALTHY_S))

    def client(self, role: str, host: str) -> Client:
        connect, credentials = f"tls/{self.address}:{self.ports[host]}", self.folder / "people" / role
        return Client(ServiceSettings(connect=connect, credentials=credentials), wait_s=HEALTHY_S)


@pytest.fixture(scope="module")
def taken(tmp_path_factory: pytest.TempPathFactory, scene_model: Path) -> Iterator[Taken]:
    """Both hosts on this machine, up, with a model, and linked by a proxy; gone afterwards."""
    docker("compose", "--file", str(MAIN), "build", "--quiet")
    address = gateway_of_bridge()
    ports = {host: int(free_endpoint().rpartition(":")[2]) for host in ("camera", "compute")}
    folder = tmp_path_factory.mktemp("deployment")
    hosts = ",".join(f"{host}={address}:{port}" for host, port in ports.items())
    actum("deploy", "init", str(folder), "--hosts", hosts, "--passwords", "--simulate")
    scene = "".join(f"ACTUM_{name.upper()}={value}\n" for name, value in SCENE.items())
    settings = folder / "camera" / "settings.env"
    settings.write_text(settings.read_text() + scene)
    with TcpProxy(ports["camera"], host=address, seed=1) as link:
        router = folder / "compute" / "router.json5"
        router.write_text(router.read_text().replace(f"{address}:{ports['camera']}", f"{address}:{link.port}"))
        assert f"{address}:{link.port}" in router.read_text(), "the routers are linked by the proxy"
        made = Taken(folder, address, ports, link)
        try:
            for host in ports:
                made.up(host)
            put_model(made, scene_model)
            yield made
        finally:
            for host in ports:
                made.compose(host, "down", "--volumes")


def put_model(taken: Taken, model: Path) -> None:
    """Put a model where the classifier waits for one."""
    [trainer] = taken.compose("compute", "ps", "--quiet", "model_trainer").split()
    with model.open("rb") as content:
        command = [
            "docker",
            "exec",
            "--interactive",
            trainer,
            "sh",
            "-c",
            "cat > /models/new && mv /models/new $ACTUM_ORIGINAL_MODEL",
        ]
        subprocess.run(command, stdin=content, check=True)


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


@pytest.mark.parametrize("disturb", [undisturbed, delayed, stalling, cut_now_and_then])
def test_the_other_host_tells_what_one_host_tells(
    taken: Taken, scene_model: Path, disturb: Callable[[TcpProxy, threading.Event], None]
) -> None:
    expected, over, prefix = on_one_host(scene_model), threading.Event(), f"{disturb.__name__}-"
    assert len(expected) == ACTIONS
    with taken.client("switch", "camera") as switch, taken.client("viewer", "compute") as viewer:
        events = viewer.listen(keys.pattern(keys.EVENT, viewer.sensor))
        truths = switch.listen(keys.key(keys.TRUTH, switch.sensor))
        assert switch.wait_for_subscriber(keys.SEGMENT, SCENE_S)
        threads = [
            threading.Thread(target=mark, args=(switch, truths, prefix, over)),
            threading.Thread(target=disturb, args=(taken.link, over)),
        ]
        for thread in threads:
            thread.start()
        try:
            taken.compose("camera", "up", "--detach", "--force-recreate", "sensor_gateway")
            heard = collect(events, Event, lambda found: len(told(found, prefix)) >= ACTIONS, SCENE_S)
        finally:
            over.set()
            for thread in threads:
                thread.join()
            taken.link.delay(0.0)
            taken.link.mend()
    assert told(heard, prefix) == expected


def test_the_hosts_share_no_network_and_nobody_is_root(taken: Taken) -> None:
    networks: list[set[str]] = []
    for host in taken.ports:
        found = [json.loads(docker("inspect", one))[0] for one in taken.compose(host, "ps", "--quiet").split()]
        networks.append({network for one in found for network in one["NetworkSettings"]["Networks"]})
        assert {one["HostConfig"]["ReadonlyRootfs"] for one in found} == {True}
        assert {docker("exec", one["Id"], "id", "-u") for one in found} == {"10001\n"}
    assert len(networks[0]) == len(networks[1]) == 1
    assert not networks[0] & networks[1]


def test_a_viewer_and_the_other_host_see_no_images_of_a_camera_that_makes_some(taken: Taken) -> None:
    with (
        taken.client("viewer", "camera") as viewer,
        taken.client("recorder", "compute") as far,
        taken.client("recorder", "camera") as recorder,
    ):
        *unseen, seen = (client.listen(f"actum/{client.sensor}/image/**") for client in (viewer, far, recorder))
        taken.compose("camera", "up", "--detach", "--force-recreate", "sensor_gateway")
        wait_until(lambda: seen.receive() is not None, "an image for who may see them", HEALTHY_S)
        assert [each.receive() for each in unseen] == [None, None]


def test_everything_stays_up_while_its_certificates_are_renewed(taken):
    before = running(taken)
    actum("deploy", "rotate", str(taken.folder))
    for host in taken.ports:
        with taken.client("viewer", host) as viewer:
            wait_until(lambda: viewer.alive() != [], f"the services of {host} are seen with the new ones", HEALTHY_S)
    assert running(taken) == before


def running(taken: Taken) -> dict[str, str]:
    """When each container was started that runs now."""
    ids = [one for host in taken.ports for one in taken.compose(host, "ps", "--quiet").split()]
    return {one["Name"]: one["State"]["StartedAt"] for one in json.loads(docker("inspect", *ids))}
