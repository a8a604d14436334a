"""The maps beside MiniSom, in one run on one core: the same data, order, start weights and decays.

    python benchmarks/som.py

Times are medians over interleaved rounds; read the ratios. Errors are computed by the same function for all.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["NUMBA_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import platform
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from statistics import median
from typing import Any

import numpy as np
from minisom import MiniSom
from numpy.typing import NDArray

from actum.som import BatchTraining, Schedule, SequentialTraining, Som, Steps, adapt_in_numpy
from actum.som.kernel import Kernel
from actum.som.sequential import fastest_kernel

Array = NDArray[Any]

SIDE = 30
VECTORS = STEPS = 20_000
EPOCHS = 10
ALPHA, RADIUS = 0.5, 10.0
ROUNDS = 3
LOOKUPS = 500
DIMENSIONS = (9, 45)
CLUSTERS = 40


@dataclass
class Row:
    """One line of the table: what was measured, in µs per unit of work, and how good the map became."""

    work: str
    by: str
    times_us: list[float]
    som: Som | None = None

    @property
    def time_us(self) -> float:
        return median(self.times_us)


def synthetic(dim: int) -> Array:
    """Clusters on a curved sheet in `dim` dimensions, as postures are: correlated, of unequal spread."""
    rng = np.random.default_rng(dim)
    sheet = rng.random((VECTORS, 3)) @ rng.normal(size=(3, dim))
    centres = rng.normal(size=(CLUSTERS, dim)) * 0.3
    noise = rng.normal(size=(VECTORS, dim)) * 0.05
    vectors: Array = np.sin(sheet + centres[rng.integers(CLUSTERS, size=VECTORS)]) + noise
    return vectors


def minisom(start: Array, **options: Any) -> MiniSom:
    """Make MiniSom with its own decays (to a third, both) and the given start weights."""
    som = MiniSom(SIDE, SIDE, start.shape[1], sigma=RADIUS, learning_rate=ALPHA, **options)
    som._weights = start.reshape(SIDE, SIDE, -1).copy()
    return som


def as_som(som: MiniSom) -> Som:
    return Som(SIDE, SIDE, som.get_weights().reshape(SIDE * SIDE, -1))


def asymptotic(first: float, count: int) -> Array:
    """MiniSom's default decay, first / (1 + t / (count / 2))."""
    values: Array = first / (1 + np.arange(count) / (count / 2))
    return values


def timed(work: Callable[[], Any]) -> float:
    began_s = time.perf_counter()
    work()
    return (time.perf_counter() - began_s) * 1e6


def sequential_row(
    name: str, start: Array, vectors: Array, dtype: type, kernel: Kernel
) -> tuple[Row, Callable[[], None]]:
    """Time all steps, on the vectors in their order, as MiniSom takes them."""
    decay = Steps(asymptotic(ALPHA, STEPS), asymptotic(RADIUS, STEPS))
    untrained = Som(SIDE, SIDE, start.astype(dtype))
    row = Row(f"sequential training, {STEPS:,} steps", name, [])

    def once() -> None:
        training = SequentialTraining(untrained, vectors, np.arange(STEPS) % VECTORS, decay, kernel)
        row.times_us.append(timed(lambda: training.run(STEPS)) / STEPS)
        row.som = training.som

    return row, once


def minisom_sequential(start: Array, vectors: Array) -> tuple[Row, Callable[[], None]]:
    row = Row(f"sequential training, {STEPS:,} steps", "MiniSom", [])

    def once() -> None:
        som = minisom(start)
        row.times_us.append(timed(lambda: som.train(vectors, STEPS)) / STEPS)
        row.som = as_som(som)

    return row, once


def minisom_batch(start: Array, vectors: Array) -> tuple[Row, Callable[[], None]]:
    """MiniSom blends the new means with the old weights by its learning rate; at 1 it is the batch map."""
    row = Row(f"batch training, {EPOCHS} epochs of {VECTORS:,}", "MiniSom train_batch_offline", [])

    def once() -> None:
        som = minisom(start, decay_function=lambda rate, _step, _steps: 1.0)
        row.times_us.append(timed(lambda: som.train_batch_offline(vectors, EPOCHS)) / EPOCHS)
        row.som = as_som(som)

    return row, once


def batch(name: str, start: Array, vectors: Array, dtype: type) -> tuple[Row, Callable[[], None]]:
    row = Row(f"batch training, {EPOCHS} epochs of {VECTORS:,}", name, [])
    inputs = vectors.astype(dtype)

    def epochs(training: BatchTraining[Som]) -> None:
        for _ in range(EPOCHS):
            training.run_epoch()

    def once() -> None:
        training = BatchTraining(Som(SIDE, SIDE, start.astype(dtype)), inputs, asymptotic(RADIUS, EPOCHS))
        row.times_us.append(timed(lambda: epochs(training)) / EPOCHS)
        row.som = training.som

    return row, once


def lookup(name: str, work: str, look: Callable[[Array], Any], vectors: Array) -> tuple[Row, Callable[[], None]]:
    """Time one call per frame."""
    row = Row(work, name, [])
    frames = list(vectors[:LOOKUPS])

    def once() -> None:
        row.times_us.append(timed(lambda: [look(frame) for frame in frames]) / LOOKUPS)

    return row, once


def lookups(start: Array, vectors: Array) -> Iterator[tuple[Row, Callable[[], None]]]:
    """Single frames one call each, and all vectors in one call where there is such a call."""
    theirs = minisom(start)
    yield lookup("MiniSom.winner", "best matching unit of one frame", theirs.winner, vectors)
    for dtype in (np.float64, np.float32):
        ours = Som(SIDE, SIDE, start.astype(dtype))
        name = f"actum, {np.dtype(dtype).name}"
        yield lookup(name, "best matching unit of one frame", ours.bmu, vectors.astype(dtype))
    yield lookup("MiniSom.winner, a loop", "best matching units of many frames", theirs.winner, vectors)
    for dtype in (np.float64, np.float32):
        yield batched(f"actum, {np.dtype(dtype).name}", Som(SIDE, SIDE, start.astype(dtype)), vectors.astype(dtype))


def batched(name: str, som: Som, vectors: Array) -> tuple[Row, Callable[[], None]]:
    row = Row("best matching units of many frames", name, [])
    return row, lambda: row.times_us.append(timed(lambda: som.bmus(vectors)) / len(vectors))


def trainings(start: Array, vectors: Array) -> Iterator[tuple[Row, Callable[[], None]]]:
    """Everything that makes a map."""
    yield minisom_sequential(start, vectors)
    yield sequential_row("actum, float64, NumPy only", start, vectors, np.float64, adapt_in_numpy)
    for dtype in (np.float64, np.float32):
        yield sequential_row(f"actum, {np.dtype(dtype).name}", start, vectors, dtype, fastest_kernel())
    yield minisom_batch(start, vectors)
    for dtype in (np.float64, np.float32):
        yield batch(f"actum, {np.dtype(dtype).name}", start, vectors, dtype)


def measured(dim: int) -> list[Row]:
    """Run everything in turn, round after round, after what is compiled has been compiled."""
    vectors = synthetic(dim)
    start = vectors[np.random.default_rng(1).choice(VECTORS, SIDE * SIDE, replace=False)]
    warm_up(start)
    tasks = [*trainings(start, vectors), *lookups(start, vectors)]
    for _ in range(ROUNDS):
        for _row, once in tasks:
            once()
    return [row for row, _once in tasks]


def warm_up(start: Array) -> None:
    for dtype in (np.float64, np.float32):
        Som(SIDE, SIDE, start.astype(dtype)).train(
            start, 10, Schedule((0.1, 0.1), (1.0, 1.0)), np.random.default_rng(0)
        )


def table(dim: int, rows: list[Row]) -> Iterator[str]:
    """Write Markdown; the first row of each kind of work is what the others are compared with."""
    vectors = synthetic(dim)
    yield f"\n{SIDE}×{SIDE} units, {dim} components\n"
    yield "| work | by | µs | times faster | QE | TE, 8 neighbours | TE, 4 neighbours |"
    yield "|---|---|---:|---:|---:|---:|---:|"
    baselines: dict[str, float] = {}
    for row in rows:
        baseline = baselines.setdefault(row.work, row.time_us)
        yield f"| {row.work} | {row.by} | {row.time_us:,.2f} | {baseline / row.time_us:.1f} | {quality(row, vectors)} |"


def quality(row: Row, vectors: Array) -> str:
    if row.som is None:
        return "| |"
    som = Som(SIDE, SIDE, row.som.weights.astype(np.float64))
    errors = som.quantization_error(vectors), som.topographic_error(vectors), som.topographic_error(vectors, 4)
    return " | ".join(f"{error:.4f}" for error in errors)


def main() -> None:
    versions = ", ".join(f"{name} {version(name)}" for name in ("minisom", "numpy"))
    print(f"Python {platform.python_version()}, {versions}; one core; medians of {ROUNDS} interleaved rounds;")
    print("µs per step, per epoch, per frame.")
    for dim in DIMENSIONS:
        print("\n".join(table(dim, measured(dim))), flush=True)


if __name__ == "__main__":
    main()
