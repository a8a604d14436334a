"""A deployment of two hosts on this machine: each with its own secured router, in processes, linked over one port."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command.processes import simulated_objects
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import hosts_of
from actum_deployer.roles import PEOPLES, identity
from actum_deployer.writing import write_deployment
from live import PATIENCE_S, Running, free_port, started, wait_until

PEOPLE = {role.name for role in PEOPLES}
MODULES = {"scene_simulator": "sensor_gateway"}
"""The service's name of each program that has another."""
ROUTER = ("-m", "actum_command", "router")
BARE_ROUTER = (
    "-c",
    """import logging, sys
from pathlib import Path
from actum.runtime import serve_router, stop_on_signals
logging.basicConfig(level="INFO")
_, _, configuration, _, credentials = sys.argv
serve_router(None, Path(configuration), stop_on_signals(), Path(credentials))
""",
)
"""A secured router without the command line around it, which takes longer to start whenever credentials change."""


@dataclass
class Deployed:
    """A deployment, its folder, and the processes that were started of it."""

    deployment: Deployment
    root: Path
    router: Sequence[str] = ROUTER
    """The arguments of Python that start a router."""
    running: list[Running] = field(default_factory=list)

    def credentials(self, identity: str) -> Path:
        """Find the folder of an identity: on the host that has it, or among people's."""
        if identity in PEOPLE:
            return self.root / "people" / identity
        [found] = self.root.glob(f"*/credentials/{identity}")
        return found

    def endpoint(self, host: str) -> str:
        [port] = [each.port for each in self.deployment.hosts if each.name == host]
        return f"{self.deployment.transport}/127.0.0.1:{port}"

    def settings(self, identity: str, host: str, sensor: str = "kinect0") -> ServiceSettings:
        folder = self.credentials(identity) if self.deployment.secured else None
        return ServiceSettings(connect=self.endpoint(host), sensor=sensor, credentials=folder)

    def client(self, identity: str, host: str, sensor: str = "kinect0", wait_s: float = PATIENCE_S) -> Client:
        return Client(self.settings(identity, host, sensor), wait_s=wait_s)

    def start(self, module: str, host: str, *arguments: str, sensor: str = "kinect0") -> Running:
        """Start a service with the credentials of its role, for a sensor or for several, such as `left,right`."""
        service = MODULES.get(module, module)
        role = next(each for each, _ in self.deployment.subjects if service in each.services)
        return self._start(module, self.environment(identity(role, sensor), host, sensor), "-m", module, *arguments)

    def start_router(self, host: str) -> Running:
        folder = self.root / host
        credentials = ("--credentials", str(folder / "credentials" / "router")) if self.deployment.secured else ()
        files = ("--config", str(folder / "router.json5"), *credentials)
        running = self._start(f"router-{host}", {**os.environ}, *self.router, *files)
        wait_until(lambda: "listens on" in running.said(), f"the router of {host} listens")
        return running

    def actum(self, identity: str, host: str, *arguments: str) -> Running:
        """Start a command as somebody."""
        return self._start(arguments[0], self.environment(identity, host), "-m", "actum_command", *arguments)

    def environment(self, identity: str, host: str, sensor: str = "kinect0") -> dict[str, str]:
        shown = {"ACTUM_CREDENTIALS": str(self.credentials(identity))} if self.deployment.secured else {}
        return {
            **os.environ,
            **shown,
            "ACTUM_CONNECT": self.endpoint(host),
            "ACTUM_SENSOR": sensor,
            "ACTUM_TRAINER_DATA": str(self.root / "teaching"),
            "OPENBLAS_NUM_THREADS": "1",
            **simulated_objects(),
        }

    def _start(self, name: str, environment: dict[str, str], *arguments: str) -> Running:
        log = self.root / f"{name}-{len(self.running)}.log"
        running = started(list(arguments), environment, log)
        self.running.append(running)
        return running

    def stop(self) -> None:
        for running in self.running:
            if running.process.poll() is None:
                running.process.terminate()
        for running in self.running:
            running.process.wait(timeout=PATIENCE_S)


def described(sensors: Sequence[str] = ("kinect0",), **options: Any) -> Deployment:
    """A camera's host for each sensor and one that computes, with ports of this machine that are free."""
    cameras = ["camera", *(f"camera-{sensor}" for sensor in sensors[1:])]
    hosts = ",".join(f"{name}=127.0.0.1:{free_port()}" for name in (*cameras, "compute"))
    return Deployment(hosts_of(hosts, ",".join(sensors)), simulated=True, **options)


@contextmanager
def deployed(root: Path, router: Sequence[str] = ROUTER, **options: Any) -> Iterator[Deployed]:
    """Write a deployment and run its routers."""
    made = Deployed(described(**options), root, router)
    write_deployment(made.deployment, root, days=30)
    try:
        for host in made.deployment.routers:
            made.start_router(host.name)
        yield made
    finally:
        made.stop()
