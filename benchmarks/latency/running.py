"""The processes that are measured: behind an open router beside bare relays, and behind one that asks who connects."""

import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from benchmarks.latency.scene import BARE_SIZES, SENSOR, bare, ours, play
from benchmarks.latency.stopwatch import Stopwatch

from actum import keys
from actum.messages import Message
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.supervising import Program, Supervisor
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.roles import ROLES
from actum_deployer.writing import write_deployment

OPEN = ServiceSettings(connect="tcp/127.0.0.1:7457", sensor=SENSOR)
SECURED = Deployment(hosts_of("camera=127.0.0.1:7458,compute=127.0.0.1"), passwords=True, one_router=True)
LEAD_IN_S, PATIENCE_S, STARTING_S = 1.0, 5.0, 30.0
RELAY = Path(__file__).parents[1] / "bare_relay.py"
ANSWERS = tuple(map(keys.pattern, (keys.POSTURE, keys.ACTION, keys.EVENT)))
WHO_PUTS = {keys.SKELETON: "gateway.kinect0", keys.OBJECTS: "tracker.kinect0", keys.SEGMENT: "switch"}
"""Who puts what this program puts, where a router asks."""


def beside_bare_chain(folder: Path, sizes: Mapping[str, int]) -> Stopwatch:
    """Play the scene through the processes and the bare chain."""
    watch = Stopwatch()
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "log"))
        supervisor.start(processes.router(OPEN), *processes.services(OPEN, folder / "model.npz", {}))
        stack.enter_context(bare_chain(sizes))
        client = stack.enter_context(Client(OPEN, wait_s=STARTING_S))
        for topic in WHO_PUTS:
            assert client.wait_for_subscriber(topic, STARTING_S)
        for pattern in (*ANSWERS, "bench/**"):
            client.tap(pattern, watch.arrived)
        time.sleep(LEAD_IN_S)
        play([*ours(client.put, watch), *bare(client, watch, sizes)])
        time.sleep(PATIENCE_S)
    return watch


def behind_security(folder: Path) -> Stopwatch:
    """Play the scene through the processes, each with its own credentials."""
    watch, root = Stopwatch(), folder / "deployment"
    write_deployment(SECURED, root, days=1)
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "secured-log"))
        supervisor.start(router(root), *secured(root, folder / "model.npz"))
        clients = {topic: stack.enter_context(client(root, who)) for topic, who in WHO_PUTS.items()}
        for topic, putting in clients.items():
            assert putting.wait_for_subscriber(topic, STARTING_S)
        viewer = stack.enter_context(client(root, "viewer"))
        for pattern in ANSWERS:
            viewer.tap(pattern, watch.arrived)
        time.sleep(LEAD_IN_S)

        def put(message: Message) -> None:
            clients[keys.address_of(message).topic].put(message)

        play(ours(put, watch))
        time.sleep(PATIENCE_S)
    return watch


def settings(root: Path, who: str) -> ServiceSettings:
    """Return the settings of somebody known to the router."""
    [folder] = [file.parent for file in root.rglob(f"{who}/key.pem")]
    return ServiceSettings(connect=f"tls/{SECURED.hosts[0].endpoint}", sensor=SENSOR, credentials=folder)


def client(root: Path, who: str) -> Client:
    """Open a session as somebody."""
    return Client(settings(root, who), wait_s=STARTING_S)


def router(root: Path) -> Program:
    """Return the program of the router that asks."""
    folder = root / "camera"
    files = ["--config", str(folder / "router.json5"), "--credentials", str(folder / "credentials" / "router")]
    return Program("router", "actum_command", ["router", *files], {})


def secured(root: Path, model: Path) -> Iterator[Program]:
    """Yield the programs of the services, each with its own credentials."""
    roles = {service: role.name for role in ROLES for service in role.services}
    for program in processes.services(OPEN, model, {}):
        here = settings(root, f"{roles[program.name]}.{SENSOR}")
        shown = {"ACTUM_CONNECT": here.connect, "ACTUM_CREDENTIALS": str(here.credentials)}
        yield replace(program, environment={**program.environment, **shown})


@contextmanager
def bare_chain(sizes: Mapping[str, int]) -> Iterator[None]:
    """Run a bare relay for each hop."""
    chain = list(BARE_SIZES)
    hops = [(a, b) for a, b in pairwise(chain) if a.rpartition("/")[0] == b.rpartition("/")[0]]
    running = [subprocess.Popen([sys.executable, str(RELAY), a, b, str(sizes[BARE_SIZES[b]])]) for a, b in hops]
    try:
        yield
    finally:
        for process in running:
            process.terminate()
        for process in running:
            process.wait()
