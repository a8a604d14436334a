"""Resident memory of each process after a minute of one simulated person, beside an interpreter with bare imports."""

import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import psutil
from benchmarks.latency.running import STARTING_S
from rich.table import Table

from actum import keys
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.simulated_model import SIMULATED_MODEL
from actum_command.supervising import Supervisor

SETTINGS = ServiceSettings(connect="tcp/127.0.0.1:7459", sensor="bench")
SECONDS = 62.0
"""Length of the run (s): as long as the classifier keeps frames."""
BARE = "import psutil, zenoh, numpy, msgpack, pydantic; print(psutil.Process().memory_info().rss)"
"""What is measured beside them: a program that imports what every service is made of."""


def resident_mb(folder: Path) -> dict[str, float]:
    """Return the resident memory (MB) of bare imports and, after a run, of each process of a system by its name."""
    bare = subprocess.run([sys.executable, "-c", BARE], capture_output=True, text=True, check=True)
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "memory-log"))
        supervisor.start(processes.router(SETTINGS), *processes.services(SETTINGS, SIMULATED_MODEL, {}))
        client = stack.enter_context(Client(SETTINGS, wait_s=STARTING_S))
        assert client.wait_for_subscriber(keys.SKELETON, STARTING_S)
        supervisor.start(processes.simulator(SETTINGS, []))
        time.sleep(SECONDS)
        of_each = {name: psutil.Process(pid).memory_info().rss for pid, name in supervisor.pids().items()}
    return {name: rss / 1e6 for name, rss in {"bare imports": int(bare.stdout), **of_each}.items()}


def resident(mb: dict[str, float]) -> Table:
    """Return a table of the memory of each process, and how many times that of bare imports it is."""
    table = Table("MB", title=f"resident memory after {SECONDS:.0f} s of one simulated person at 30 frames/s")
    for heading in ("resident", "times bare imports"):
        table.add_column(heading, justify="right")
    bare, *_ = mb.values()
    for name, used in mb.items():
        table.add_row(name, f"{used:.0f}", f"{used / bare:.1f}")
    return table
