"""Latency per hop at the sensor's pace beside a bare Zenoh chain, behind security, memory, throughput (make bench).

Prints the tables, and writes them to results.md with the commit.

Router, preprocessor, classifier and fusion run as processes. This program puts the simulated scene's skeletons at 30
frames/s with objects at 15 a second, 40 ms late as a tracker's are, and marks; halfway between two frames it puts a
payload of the same size into a chain of as many bare relays. All times are taken by this process's clock. The same
scene then goes through a router that asks for certificates and passwords, and allows each what its role may do. The
memory is that of another run, for a minute.
"""

import os
import subprocess
import tempfile
from pathlib import Path

from benchmarks.latency import running, stopwatch
from benchmarks.latency.decision import OBJECTS_EACH, PEOPLE, decisions_ms, inputs
from benchmarks.latency.memory import resident, resident_mb
from benchmarks.latency.people import load
from benchmarks.latency.scene import payload_sizes, stream
from benchmarks.rig.numpy_alone import numpy_alone
from benchmarks.throughput import frames_per_second
from rich.console import Console

from actum.core import steps
from actum.recording import Recording
from actum_command import processes
from actum_command.scene_marks import write_examples
from actum_command.simulated_model import SIMULATED_MODEL
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model import Model
from som_classifier.model_loading import load_model
from som_classifier.node import SomClassifier
from som_classifier.presets import DEFAULT

PAGE = Path(__file__).with_name("results.md")
CROWDS = (1, 20, 60)
"""How many people."""
RUNS = 3
"""How often frames per second are measured."""
HEADER = """# Latency and throughput

`make bench` at commit {}. Machines differ and are busy: read the ratios.
"""


def main() -> None:
    """Run everything and print the tables."""
    console = Console(highlight=False, width=110, record=True)
    os.environ.update(processes.common(running.OPEN))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = trained(folder)
        sizes = payload_sizes(model)
        plain = running.beside_bare_chain(folder, sizes).took_ms
        secured = running.behind_security(folder).took_ms
        memory = resident_mb(folder)
    frames, segments = len(plain["bench/frame/2"]), len(plain["mark event"])
    console.print(f"{frames} frames at 30/s, {segments} actions; payloads in bytes: {sizes}")
    console.print(stopwatch.beside_bare(plain))
    console.print(stopwatch.behind_security(secured, plain))
    console.print(resident(memory))
    print_costs(console, model)
    PAGE.write_text(HEADER.format(commit()) + f"\n```text\n{console.export_text()}```\n")


def print_costs(console: Console, model: Model) -> None:
    """Print what the nodes cost without any transport."""
    console.print("preprocessor + classifier on one core, codec included, partial answers in all frames of a segment:")
    rates = [most_frames_per_second(model)]
    with numpy_alone():
        rates.append(most_frames_per_second(model))
    compiled = "with compiled steps" if steps else "without a C compiler"
    console.print(f"{compiled} {rates[0]:,.0f} frames/s, with NumPy alone {rates[1]:,.0f}")
    took_ms, events = decisions_ms(list(inputs()))
    p50, _, p99 = stopwatch.percentiles(took_ms)
    console.print(f"fusion's decision, {PEOPLE} people, {PEOPLE * OBJECTS_EACH} objects, {len(events)} events:")
    console.print(f"{p50:.1f} ms, p99 {p99:.1f} ms (aim: 2)")
    for each in (load(people, load_model(SIMULATED_MODEL)) for people in CROWDS):
        console.print(
            f"{each.people} people at 30 frames/s, search on, preprocessor + classifier: {each.core:.2f} of a core; "
            f"a posture in the classifier {each.p50_ms:.2f} ms, p99 {each.p99_ms:.2f} ms"
        )


def most_frames_per_second(model: Model) -> float:
    """Return the fastest of some runs: whatever else the machine does only slows it down."""
    return max(
        frames_per_second(stream(), PosePreprocessor(PoseSettings.defaults()), SomClassifier(model))
        for _ in range(RUNS)
    )


def commit() -> str:
    """Return the commit that is measured, and whether it was changed."""
    git = ["git", "-C", str(PAGE.parent), "describe", "--always", "--dirty", "--exclude", "*"]
    return subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()


def trained(folder: Path) -> Model:
    """Train the demo's model and leave it as `model.npz`."""
    write_examples(folder / "examples.mcap", repetitions=12, actor=0, seed=1)
    model = train(samples_from([Recording(folder / "examples.mcap")]).usable, DEFAULT)
    model.save(folder / "model.npz")
    return model


if __name__ == "__main__":
    main()
