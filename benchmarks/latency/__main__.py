"""Latency per hop at the sensor's pace beside a bare Zenoh chain, behind security, and throughput (make bench).

Router, preprocessor, classifier and fusion run as processes. This program puts the simulated scene's skeletons at 30
frames/s with objects at 15 a second, 40 ms late as a tracker's are, and marks; halfway between two frames it puts a
payload of the same size into a chain of as many bare relays. All times are taken by this process's clock. The same
scene then goes through a router that asks for certificates and passwords, and allows each what its role may do.
"""

import os
import tempfile
from pathlib import Path

from benchmarks.latency import running, stopwatch
from benchmarks.latency.decision import OBJECTS_EACH, PEOPLE, decisions_ms, inputs
from benchmarks.latency.scene import payload_sizes, stream
from benchmarks.throughput import frames_per_second
from rich.console import Console

from actum.recording import Recording
from actum_command import processes
from actum_command.scene_marks import write_examples
from actum_model_trainer.samples import samples_from
from actum_model_trainer.training import train
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.presets import DEFAULT


def main() -> None:
    """Run everything and print the tables."""
    console = Console(highlight=False, width=110)
    os.environ.update(processes.common(running.OPEN))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model = trained(folder)
        sizes = payload_sizes(model)
        plain = running.beside_bare_chain(folder, sizes).took_ms
        secured = running.behind_security(folder).took_ms
    frames, segments = len(plain["bench/frame/2"]), len(plain["mark event"])
    console.print(f"{frames} frames at 30/s, {segments} actions; payloads in bytes: {sizes}")
    console.print(stopwatch.beside_bare(plain))
    console.print(stopwatch.behind_security(secured, plain))
    rate = frames_per_second(stream(), PosePreprocessor(PoseSettings.defaults()), SomClassifier(model))
    console.print(
        "preprocessor + classifier on one core, codec included, a partial estimate in every frame of a segment:"
    )
    console.print(f"{rate:,.0f} frames/s (aim: 1,500)")
    took_ms, events = decisions_ms(list(inputs()))
    p50, _, p99 = stopwatch.percentiles(took_ms)
    console.print(f"fusion's decision, {PEOPLE} people, {PEOPLE * OBJECTS_EACH} objects, {len(events)} events:")
    console.print(f"{p50:.1f} ms, p99 {p99:.1f} ms (aim: 2)")


def trained(folder: Path) -> Model:
    """Train the demo's model and leave it as `model.npz`."""
    write_examples(folder / "examples.mcap", repetitions=12, actor=0, seed=1)
    model = train(samples_from([Recording(folder / "examples.mcap")]).usable, DEFAULT)
    model.save(folder / "model.npz")
    return model


if __name__ == "__main__":
    main()
