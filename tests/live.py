"""Real processes for system tests: a router and services of one system, on a port of their own."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

import zenoh

from actum.messages import Info, Message
from actum.runtime import Client, Listening
from actum.runtime.router import router_config
from actum.settings import ServiceSettings
from forked import Forked

PATIENCE_S = 30.0
POLL_S = 0.02
FEW_IMAGES_HZ = "5"
"""Where any event will do: most of a simulated scene's CPU is drawing images and finding markers in them."""
ROUTER = """import sys
from pathlib import Path
from actum.runtime import serve_router, stop_on_signals
serve_router(sys.argv[1], Path(sys.argv[2]) if sys.argv[2:] else None, stop_on_signals())
"""
"""The embedded router without the command line around it, which takes longer to start."""
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
"""Which of the processes that run tests side by side this is."""
FIRST_PORT, PORTS_EACH = 12_000, 1_250
"""The ports of each of up to 16: below those that Linux gives to outgoing connections, from 32768 on."""
NUMBERS = count(os.getpid())
"""Where in these this process begins: the tests of another checkout may run as well."""


def free_endpoint() -> str:
    """An endpoint that nothing listens on, and that no other test or outgoing connection takes meanwhile."""
    while True:
        port = FIRST_PORT + PORTS_EACH * WORKER + next(NUMBERS) % PORTS_EACH
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return f"tcp/127.0.0.1:{port}"


def free_port() -> int:
    """The port of a free endpoint. No other test takes the next port either, unless this one asks for it."""
    return int(free_endpoint().rpartition(":")[2])


def wait_until(condition: Callable[[], bool], what: str, patience_s: float = PATIENCE_S) -> None:
    """Wait on a condition; fail naming it."""
    deadline_s = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < deadline_s, f"waited {patience_s:g} s in vain: {what}"
        threading.Event().wait(POLL_S)


def described(client: Client) -> Info:
    """Wait until one service says what it is, which it does once it has its place."""
    asked: list[list[Info]] = []

    def answers_alone() -> bool:
        asked.append(client.infos())
        return len(asked[-1]) == 1

    wait_until(answers_alone, "one service describes itself")
    return asked[-1][0]


@dataclass
class Running:
    """A process and what it prints."""

    process: subprocess.Popen[bytes] | Forked
    log: Path

    def said(self) -> str:
        return self.log.read_text()

    def terminate(self) -> float:
        """Send SIGTERM and return how long it took to end, in seconds."""
        began_s = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=PATIENCE_S)
        return time.monotonic() - began_s


def started(arguments: list[str], environment: dict[str, str], log: Path) -> Running:
    """Start a Python program whose output goes to a file."""
    log.touch()
    if "LD_PRELOAD" not in environment:
        return Running(Forked(arguments, environment, log, log), log)
    with log.open("wb") as output:  # what is preloaded takes effect only as a program is loaded
        process = subprocess.Popen(
            [sys.executable, *arguments],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
        )
    return Running(process, log)


@dataclass
class System:
    """Processes that share a router's endpoint and a sensor."""

    folder: Path
    settings: ServiceSettings
    running: list[Running] = field(default_factory=list)
    variables: dict[str, str] = field(default_factory=dict)
    """What stands in the environment besides."""
    routers: list[zenoh.Session] = field(default_factory=list)
    """Routers in this process."""

    @property
    def environment(self) -> dict[str, str]:
        return {
            **os.environ,
            "ACTUM_CONNECT": self.settings.connect,
            "ACTUM_SENSOR": self.settings.sensor,
            "ACTUM_TRAINER_DATA": str(self.folder / "teaching"),
            "OPENBLAS_NUM_THREADS": "1",
            **self.variables,
        }

    def start(self, module: str, *arguments: str) -> Running:
        return self._start(module, "-m", module, *arguments)

    def start_script(self, script: Path, *arguments: str) -> Running:
        """Start a script, which can import what lies beside it."""
        return self._start(script.stem, str(script), *arguments)

    def start_router(self) -> None:
        """Start a router in this process, which costs no start of a process: it cannot be killed."""
        self.routers.append(zenoh.open(router_config(self.settings.connect, None)))

    def start_router_process(self, configuration: Path | None = None) -> Running:
        given = [] if configuration is None else [str(configuration)]
        return self._start("router", "-c", ROUTER, self.settings.connect, *given)

    def _start(self, name: str, *arguments: str) -> Running:
        log = self.folder / f"{name}-{len(self.running)}.log"
        running = started(list(arguments), self.environment, log)
        self.running.append(running)
        return running

    def actum(self, *arguments: str, timeout_s: float = 60.0) -> subprocess.CompletedProcess[str]:
        """Run a command of ours to its end."""
        with TemporaryDirectory() as folder:
            output, errors = Path(folder) / "output", Path(folder) / "errors"
            command = Forked(["-m", "actum_command", *arguments], self.environment, output, errors)
            try:
                code = command.wait(timeout_s)
            finally:
                command.kill()
            return subprocess.CompletedProcess(arguments, code, output.read_text(), errors.read_text())

    def client(self, sensor: str | None = None) -> Client:
        settings = self.settings.model_copy(update={"sensor": sensor or self.settings.sensor})
        return Client(settings, wait_s=PATIENCE_S)

    def wait_for_services(self, client: Client, *names: str) -> None:
        def alive() -> set[str]:
            return {key.split("/")[-2] for key in client.alive()}

        wait_until(lambda: alive() >= set(names), f"{names} are alive")

    def stop(self) -> None:
        for running in self.running:
            if running.process.poll() is None:
                running.process.terminate()
        for running in self.running:
            running.process.wait(timeout=PATIENCE_S)
        for router in self.routers:
            router.close()


@contextmanager
def system(folder: Path) -> Iterator[System]:
    made = System(folder, ServiceSettings(connect=free_endpoint(), sensor="kinect0"))
    try:
        yield made
    finally:
        made.stop()


def collect(
    listening: Listening, kind: type[Message], done: Callable[[list], bool], patience_s: float = PATIENCE_S
) -> list:
    """Gather messages of a kind until enough are there."""
    found: list = []

    def enough() -> bool:
        while (received := listening.receive()) is not None:
            if isinstance(received.message, kind):
                found.append(received.message)
        return done(found)

    wait_until(enough, f"enough {kind.__name__} messages, {len(found)} so far", patience_s)
    return found
