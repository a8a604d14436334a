"""What training costs as its set grows: seconds and the peak of memory, by the number of labelled segments.

    python -m benchmarks.growth [SEGMENTS_PER_ACTION …] [--actions N] [--jobs N]

The set is generated: each action is a pair of simulated actions one after the other, as they are or backwards or
mirrored, done by people of other proportions, tempos and noise. Each size is trained in a process of its own.
Generating recordings is not counted; choosing what is kept of them is. What reading them would take is the time of
reading one, times their number.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.recording import Recording
from actum_command.scene_marks import write_examples
from actum_model_trainer.augmentation import Variant, varied
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample
from actum_model_trainer.sampling import Sampling
from actum_model_trainer.side_by_side import at_most
from actum_model_trainer.training import train_to_spot
from som_classifier.presets import DEFAULT, BodyVariation

Array = NDArray[np.float64]
Action = tuple[str, str, bool, bool]
"""What is done first and second, whether backwards, and whether mirrored."""

SIZES = (10, 100, 1_000, 10_000)
"""Segments of each action: up to a million in all."""
ACTIONS = 100
IN_RECORDING = 20
"""Segments of each recording."""
PEOPLE = 50
FRAME_NS = SECOND_NS // 30
REST_FRAMES = 30
"""Frames of standing before each segment: one second."""
NOISE_M = 0.004
"""Standard deviation of each coordinate: that of a depth camera's joints."""
TEMPO_SD = 0.2
"""Standard deviation of the logarithm of a segment's tempo."""
BODIES = replace(DEFAULT, turns_deg=(), leans_deg=(), others=BodyVariation(1, build_sd=0.1, tempo=1.0))
"""One other body for each person."""


@cache
def simulated() -> tuple[list[SegmentSample], float]:
    """Return the simulated actions, each four times, and how long reading a segment of a recording takes (s)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "examples.mcap"
        write_examples(path, repetitions=4, actor=0, seed=1)
        began_s = time.perf_counter()
        samples = samples_from([Recording(path)]).usable
    return samples, (time.perf_counter() - began_s) / len(samples)


def actions(count: int) -> list[Action]:
    """Return the generated actions: 25 pairs, each in four ways."""
    labels = sorted({sample.label for sample in simulated()[0]})
    flags = (False, True)
    every = [(one, other, back, mirror) for back, mirror, one, other in product(flags, flags, labels, labels)]
    return every[:count]


def recordings(of: list[Action], each: int) -> Iterator[Samples]:
    """Yield what recordings hold in which every action is done so often, in a mixed order."""
    order = np.random.default_rng(0).permutation(np.repeat(np.arange(len(of)), each))
    for number, first in enumerate(range(0, len(order), IN_RECORDING)):
        yield recorded([of[index] for index in order[first : first + IN_RECORDING]], number)


def recorded(done: list[Action], number: int) -> Samples:
    """Return a recording of one person who does these actions with a rest before each."""
    rng, person = np.random.default_rng(number), str(number % PEOPLE)
    parts, bounds, frames = [], [], 0
    for action in done:
        moving = performed(action, int(person), rng)
        parts.append([np.concatenate(pair) for pair in zip(rest_before(moving), moving, strict=True)])
        bounds.append((frames + REST_FRAMES, frames + len(parts[-1][0])))
        frames = bounds[-1][1]
    postures, velocities, motion = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    postures = postures + rng.normal(0, NOISE_M, postures.shape)
    stamps_ns = np.arange(frames, dtype=np.int64) * FRAME_NS
    labels = [" ".join(map(str, action)) for action in done]
    spans = [(int(stamps_ns[first]), int(stamps_ns[after - 1])) for first, after in bounds]
    marks = tuple((*span, label) for span, label in zip(spans, labels, strict=True))
    stream = LabelledStream(stamps_ns, motion, postures, velocities, marks, person, f"{number}.mcap", 1)
    return Samples([cut(stream, label, *own) for label, own in zip(labels, bounds, strict=True)], [stream])


def rest_before(moving: list[Array]) -> list[Array]:
    """Return the postures, velocities and motion of standing as somebody does at the start of a movement."""
    postures, *others = moving
    still = [np.zeros((REST_FRAMES, *array.shape[1:])) for array in others]
    return [np.repeat(postures[:1], REST_FRAMES, axis=0), *still]


def cut(stream: LabelledStream, label: str, first: int, after: int) -> SegmentSample:
    """Return some of a stream's frames as a sample, in memory of its own as of a recording that was read."""
    arrays = {name: getattr(stream, name)[first:after].copy() for name in ("postures", "motion", "velocities")}
    stamps_ns = stream.stamps_ns[first:after].copy()
    joints = arrays["postures"].copy()
    return SegmentSample(
        label, stamps_ns, joints, **arrays, person=stream.person, file=stream.file, segment_id=str(first)
    )


def performed(action: Action, person: int, rng: np.random.Generator) -> list[Array]:
    """Return postures, velocities and motion of an action: every frame of both parts at twice their tempo and more."""
    one, other, backwards, in_mirror = action
    parts = [_one_of(label, rng) for label in (one, other)]
    arrays = [np.concatenate([getattr(part, name) for part in parts]) for name in ("postures", "velocities", "motion")]
    tempo = 2 * np.exp(rng.normal(0, TEMPO_SD))
    frames = np.arange(0, len(arrays[0]) - 1, tempo).astype(np.intp)
    frames = frames[::-1] if backwards else frames
    speeds = (1.0, -tempo if backwards else tempo, tempo)
    postures, velocities, motion = (speed * array[frames] for speed, array in zip(speeds, arrays, strict=True))
    body = list(varied(Variant((postures, velocities)), False, BODIES, np.random.default_rng(person)))[-1]
    seen = body.mirrored if in_mirror else body
    return [seen.postures, seen.velocities, motion]


def _one_of(label: str, rng: np.random.Generator) -> SegmentSample:
    own = [sample for sample in simulated()[0] if sample.label == label]
    return own[rng.integers(len(own))]


def measure(count: int, each: int, jobs: int | None) -> dict[str, float]:
    """Train one size in this process."""
    sampling, choosing_s, choosing_cpu_s = Sampling(), 0.0, 0.0
    for samples in recordings(actions(count), each):
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        sampling.add(samples)
        choosing_s += time.perf_counter() - began_s
        choosing_cpu_s += time.process_time() - began_cpu_s
    kept = sampling.samples
    began_s, began_cpu_s = time.perf_counter(), time.process_time()
    with at_most(jobs):
        model = train_to_spot(kept.usable, kept.streams, DEFAULT)
    return {
        "segments": count * each,
        "kept": len(kept.usable),
        "stream_frames": sum(len(stream.stamps_ns) for stream in kept.streams),
        "reading_s": simulated()[1] * count * each,
        "choosing_s": choosing_s,
        "choosing_cpu_s": choosing_cpu_s,
        "training_s": time.perf_counter() - began_s,
        "training_cpu_s": time.process_time() - began_cpu_s,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000,
        "held_out": float(np.mean([done == answered for done, answered in model.metadata.held_out_answers])),
    }


def main() -> None:
    """Measure all sizes, each in a process of its own, and print a table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__)
    parser.add_argument("sizes", nargs="*", type=int, default=SIZES, help="segments of each action")
    parser.add_argument("--actions", type=int, default=ACTIONS)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.here:
        print(json.dumps(measure(asked.actions, asked.sizes[0], asked.jobs)))
        return
    heads = (
        "segments",
        "kept",
        "frames of streams",
        "reading, s",
        "choosing, s (CPU)",
        "training, s (CPU)",
        "peak, MB",
    )
    print(f"| {' | '.join(heads)} | held out |\n|{'---|' * (len(heads) + 1)}", flush=True)
    for each in asked.sizes:
        flags = ["--actions", str(asked.actions), "--here", *(["--jobs", str(asked.jobs)] if asked.jobs else [])]
        command = [sys.executable, "-m", "benchmarks.growth", str(each), *flags]
        print(row(json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)), flush=True)


def row(found: dict[str, float]) -> str:
    """Lay out what `measure` has found as a row of the table."""
    cells = (
        f"{found['segments']}",
        f"{found['kept']}",
        f"{found['stream_frames']}",
        f"{found['reading_s']:.0f}",
        f"{found['choosing_s']:.1f} ({found['choosing_cpu_s']:.1f})",
        f"{found['training_s']:.0f} ({found['training_cpu_s']:.0f})",
        f"{found['peak_mb']:.0f}",
        f"{found['held_out']:.3f}",
    )
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
