"""Two hosts in processes: a router each, linked over one port, and a proxy before each program's way to its router."""

import json
import os
import signal
import socket
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from benchmarks.rig.linked_router import router_configuration
from benchmarks.rig.tcp_proxy import TcpProxy

from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.supervising import Program, Supervisor

from .faults import CAMERA_HOST, LINK, ROUTERS, SERVICES, Fault

CLIENT = "client"
"""The way of the program that marks and listens, on the compute host."""
FOREVER_S = 3600.0
"""A stall without an end of its own: `relieve` ends it."""
SIMULATOR = "scene_simulator"
"""The program that is the sensor gateway here."""


class TwoHosts:
    """Router, simulated scene and tracker on one host; router, preprocessor, classifier and fusion on the other.

    Args:
        settings: whose sensor it is; where a program connects to, it is told by itself.
        programs: the services, the simulated scene for the gateway.
        folder: where the log, the routers' configurations and the services' states are written.
        seed: of the proxies.
    """

    def __init__(self, settings: ServiceSettings, programs: Sequence[Program], folder: Path, seed: int) -> None:
        self._settings, self._folder = settings, folder
        self.log = folder / "log.txt"
        self._closing = ExitStack()
        self._ports = dict(zip(ROUTERS, _free_ports(len(ROUTERS)), strict=True))
        self._proxies: dict[str, TcpProxy] = {}
        for number, name in enumerate((*SERVICES, LINK, CLIENT)):
            self._proxies[name] = TcpProxy(self._ports[_router_of(name)], seed=seed + number)
        services = {_name_of(program): self._placed(program) for program in programs}
        self._programs = {**{router: self._router(router) for router in ROUTERS}, **services}
        self._paused: dict[str, int] = {}

    def __enter__(self) -> Self:
        for proxy in self._proxies.values():
            self._closing.enter_context(proxy)
        self._supervisor = self._closing.enter_context(Supervisor(self.log))
        self._supervisor.start(*self._programs.values())
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        for name in list(self._paused):
            self._go_on(name)
        self._closing.close()

    @property
    def client_settings(self) -> ServiceSettings:
        """The settings of the program that marks and listens."""
        return self._settings.model_copy(update={"connect": self._endpoint(CLIENT)})

    @property
    def link_bytes(self) -> tuple[int, int]:
        """Bytes that the link has carried: to the compute host, and from it."""
        return self._proxies[LINK].carried_bytes

    def restart_ended(self) -> list[str]:
        """Restart what has ended, as `Supervisor.restart_ended` does, and note it in the log."""
        lines = self._supervisor.restart_ended()
        for line in lines:
            self.note(line)
        return lines

    def note(self, line: str) -> None:
        """Write a line into the log, between those of the programs."""
        with self.log.open("a") as file:
            file.write(f"--- {time.strftime('%H:%M:%S')} {line}\n")

    def strike(self, fault: Fault) -> None:
        """Let a fault begin."""
        self.note(f"fault: {fault}")
        match fault.kind:
            case "killed":
                os.kill(self._supervisor.process_id(self._programs[fault.victim]), signal.SIGKILL)
            case "paused":
                self._paused[fault.victim] = self._supervisor.process_id(self._programs[fault.victim])
                os.kill(self._paused[fault.victim], signal.SIGSTOP)
            case "cut":
                for proxy in self._ways(fault.victim):
                    proxy.cut()
            case "silent":
                for proxy in self._ways(fault.victim):
                    proxy.stall(FOREVER_S)

    def relieve(self, fault: Fault) -> None:
        """Let a fault end; one that is killed is started again by its supervisor."""
        self.note(f"over: {fault}")
        if fault.kind == "paused":
            self._go_on(fault.victim)
        elif fault.kind != "killed":
            for proxy in self._ways(fault.victim):
                proxy.mend()

    def _go_on(self, victim: str) -> None:
        os.kill(self._paused.pop(victim), signal.SIGCONT)

    def _ways(self, victim: str) -> list[TcpProxy]:
        """List the proxies before a victim: a service's own, a router's link and those of all who connect to it."""
        if victim not in ROUTERS:
            return [self._proxies[victim]]
        return [proxy for name, proxy in self._proxies.items() if name == LINK or _router_of(name) == victim]

    def _endpoint(self, name: str) -> str:
        return f"tcp/127.0.0.1:{self._proxies[name].port}"

    def _placed(self, program: Program) -> Program:
        """Return a service's program with its own way to its router, and a folder for what it has to remember."""
        name = _name_of(program)
        state = self._folder / "state" / name
        state.mkdir(parents=True, exist_ok=True)
        own = {"ACTUM_CONNECT": self._endpoint(name), "ACTUM_STATE": str(state)}
        return replace(program, environment={**program.environment, **own})

    def _router(self, name: str) -> Program:
        """Return the program of a router; the camera's connects to the other one, for as long as it takes."""
        listened = f"tcp/127.0.0.1:{self._ports[name]}"
        file = self._folder / f"{name}.json5"
        link = None if name == _router_of(LINK) else self._endpoint(LINK)
        file.write_text(json.dumps(router_configuration(link)))
        arguments = ["router", "--config", str(file), "--listen", listened]
        return Program(name, "actum_command", arguments, processes.common(self._settings))


def _router_of(name: str) -> str:
    """Return the router to which a service's, the client's or the link's proxy leads."""
    return ROUTERS[0] if name in CAMERA_HOST else ROUTERS[1]


def _name_of(program: Program) -> str:
    return SERVICES[0] if program.name == SIMULATOR else program.name


def _free_ports(count: int) -> list[int]:
    with ExitStack() as probes:
        bound = [probes.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [probe.getsockname()[1] for probe in bound]
