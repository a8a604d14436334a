"""All services, a router, the page with a viewer and the bridge to ROS 2 run for minutes while four people act before
one camera at 30 frames a second. Print memory of each process, losses and latency by the minute, and a verdict.
"""

import argparse
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
from benchmarks.soak.observing import ROWS, Memory, Watch
from rich.console import Console
from rich.table import Table
from websockets.sync.client import connect

from actum import keys
from actum.recording import Recording
from actum.runtime import Client
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.model_in_use import ModelInUse
from actum_command.scene_marks import write_examples
from actum_command.supervising import Program, Supervisor
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from som_classifier.presets import DEFAULT

SETTINGS = ServiceSettings(connect="tcp/127.0.0.1:7467", sensor="soak")
PAGE_PORT = 7468
SERVICES = (*processes.SERVICES, "sensor_gateway", "model_trainer", "web_dashboard", "ros2_bridge")
SHORTEST = 3
"""Fewest minutes that tell anything."""
WARM_UP_S = 30.0
"""From when all are alive to the first minute: with it, memory of a minute of streams is full as that ends."""
MOST_GROWTH = 0.03
"""Growth of resident memory after the first minute that is still none."""
ENDS_S = 20.0
"""Memory at an end of the time is the median over this long (s)."""
STEADY_RATIO, STEADY_MS = 1.5, 5.0
"""The 99th percentile is flat if it does not rise more than so many times and milliseconds: one late frame of a minute
is in it."""


def main() -> None:
    """Run, print, and exit with 1 where the verdict is bad."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=int, default=20)
    parser.add_argument("--image-hz", type=int, default=30, help="as `python -m scene_simulator`; 0 for none")
    given = parser.parse_args()
    if given.minutes < SHORTEST:
        parser.error(f"{SHORTEST} minutes at least: the first is left out, and what follows is compared")
    console = Console(highlight=False, width=120)
    os.environ.update(processes.common(SETTINGS) | {"ACTUM_IMAGE_HZ": str(given.image_hz)})
    with tempfile.TemporaryDirectory() as name, running(Path(name)) as (client, memory, watch):
        soak(memory, watch, given.minutes)
        infos = {info.service for info in client.infos()}
    console.print(memory_table(memory, given.minutes))
    console.print(latency_table(watch))
    problems = [*verdict(memory, watch), *(f"{name} does not answer" for name in SERVICES if name not in infos)]
    rejects = {s.service: s.rejects for s in watch.statuses.values() if s.rejects}
    console.print(f"{len(watch.marked)} segments marked; rejects, each told: {rejects or 'none'}")
    console.print("\n".join(problems) or "well: memory flat, nothing lost, latency flat")
    sys.exit(1 if problems else 0)


@contextmanager
def running(folder: Path) -> Iterator[tuple[Client, Memory, Watch]]:
    """Start everything, and wait until it is alive and has run warm."""
    watch = Watch()
    with ExitStack() as stack:
        supervisor = stack.enter_context(Supervisor(folder / "log"))
        supervisor.start(*programs(folder))
        client = stack.enter_context(Client(SETTINGS, wait_s=30.0))
        wait_for_all(client)
        client.tap(
            keys.everything(SETTINGS.sensor), lambda s: None if "/image/" in str(s.key_expr) else watch.arrived(s)
        )
        viewer = stack.enter_context(connect(f"ws://127.0.0.1:{PAGE_PORT}/ws", max_size=None))
        threading.Thread(target=lambda: [None for _ in viewer], daemon=True).start()
        time.sleep(WARM_UP_S)
        yield client, Memory(supervisor.pids()), watch


def programs(folder: Path) -> list[Program]:
    """Return the whole system; its classifier has the demo's model."""
    write_examples(folder / "examples.mcap", repetitions=12, actor=0, seed=1)
    train(samples_from([Recording(folder / "examples.mcap")]).usable, DEFAULT).save(folder / "model.npz")
    given = {"trainer_data": [str(folder / "teaching")], "page_port": [str(PAGE_PORT)]}
    model, objects = folder / "model.npz", processes.simulated_objects()
    common = processes.common(SETTINGS)
    services = [*processes.services(SETTINGS, model, objects), processes.trainer(SETTINGS, ModelInUse(model), given)]
    return [
        processes.router(SETTINGS),
        *processes.with_page(SETTINGS, services, given),
        Program("ros2_bridge", "ros2_bridge", [], common),
        Program("crowd", "benchmarks.soak.crowd", [], common),
    ]


def wait_for_all(client: Client) -> None:
    """Wait until all services are alive."""
    deadline_s = time.monotonic() + 60
    while missing := set(SERVICES) - {key.split("/")[-2] for key in client.alive()}:
        if time.monotonic() > deadline_s:
            sys.exit(f"not alive after a minute: {', '.join(sorted(missing))}")
        time.sleep(0.5)


def soak(memory: Memory, watch: Watch, minutes: int) -> None:
    """Measure memory once a second for so many minutes."""
    began_s = time.monotonic()
    for second in range(60 * minutes):
        watch.minute = second // 60 + 1
        time.sleep(max(began_s + second - time.monotonic(), 0))
        memory.measure(second)


def growth(samples_mb: Sequence[tuple[float, float]]) -> float:
    """Return by which share memory grew, from the end of the first minute to the end."""
    end_s = samples_mb[-1][0]
    after = [mb for at_s, mb in samples_mb if 60 <= at_s < 60 + ENDS_S]
    last = [mb for at_s, mb in samples_mb if at_s > end_s - ENDS_S]
    return float(np.median(last) / np.median(after)) - 1 if after else 0.0


def verdict(memory: Memory, watch: Watch) -> Iterator[str]:
    """Yield what is wrong."""
    for name, samples_mb in memory.mb.items():
        if growth(samples_mb) >= MOST_GROWTH:
            yield f"{name} grows by {growth(samples_mb):.1%} after the first minute"
    yield from (f"lost: {n} of {what}" for what, n in watch.lost().items())
    yield from (f"{segment} has {watch.events[segment]} events" for segment in sorted(watch.unanswered()))
    for row in ROWS:
        early, late = _halves(watch.p99_ms(row)[1:])
        if not late <= STEADY_RATIO * early + STEADY_MS:
            yield f"{row}: the 99th percentile rises from {early:.1f} to {late:.1f} ms"


def _halves(p99_ms: Sequence[float]) -> tuple[float, float]:
    """Return the medians of the first half and of the second; twice the same where there is one."""
    middle = len(p99_ms) // 2
    return float(np.median(p99_ms[: max(middle, 1)])), float(np.median(p99_ms[middle:]))


def memory_table(memory: Memory, minutes: int) -> Table:
    """Lay out resident memory: after the first minute and at three later times, the most, and the growth."""
    shown = sorted({1, *(round(minutes * share) for share in (0.25, 0.5, 0.75))} - {0})
    table = Table("process", title="resident memory, MB")
    for heading in (*(f"at {minute} min" for minute in shown), "end", "most", "growth"):
        table.add_column(heading, justify="right")
    for name, samples_mb in memory.mb.items():
        values = [mb for _, mb in samples_mb]
        then = [values[60 * minute] for minute in shown]
        columns = (f"{mb:.1f}" for mb in (*then, values[-1], max(values)))
        table.add_row(name, *columns, f"{growth(samples_mb):+.1%}")
    return table


def latency_table(watch: Watch) -> Table:
    """Lay out the 99th percentile of each latency by the minute."""
    table = Table("minute", *(f"{row}, p99 ms" for row in ROWS))
    columns = [watch.p99_ms(row) for row in ROWS]
    for minute, values in enumerate(zip(*columns, strict=True), start=1):
        table.add_row(str(minute), *(f"{value:.1f}" for value in values))
    return table


if __name__ == "__main__":
    main()
