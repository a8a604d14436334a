"""The maps beside MiniSom, in one run on one core: the same data, order, start weights and decays.

    python benchmarks/som.py

Times are medians over interleaved rounds; read the ratios. Errors are computed by the same function for all.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["NUMBA_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import platform
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
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
DTYPES: Mapping[str, type] = {"actum, float64": np.float64, "actum, float32": np.float32}


@dataclass
class Row:
    """One line of the table: what was measured, in µs per unit of work, and how good the map became.

    `run` does the work once; it returns the time per unit (µs), and the map where one was trained.
    """

    work: str
    by: str
    run: Callable[[], tuple[float, Som | None]]
    times_us: list[float] = field(default_factory=list)
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


def sequential(untrained: Som, vectors: Array, kernel: Kernel) -> tuple[float, Som]:
    """Time all steps, on the vectors in their order, as MiniSom takes them."""
    decay = Steps(asymptotic(ALPHA, STEPS), asymptotic(RADIUS, STEPS))
    training = SequentialTraining(untrained, vectors, np.arange(STEPS) % VECTORS, decay, kernel)
    return timed(lambda: training.run(STEPS)) / STEPS, training.som


def minisom_sequential(start: Array, vectors: Array) -> tuple[float, Som]:
    som = minisom(start)
    return timed(lambda: som.train(vectors, STEPS)) / STEPS, as_som(som)


def minisom_batch(start: Array, vectors: Array) -> tuple[float, Som]:
    """MiniSom blends the new means with the old weights by its learning rate; at 1 it is the batch map."""
    som = minisom(start, decay_function=lambda rate, _step, _steps: 1.0)
    return timed(lambda: som.train_batch_offline(vectors, EPOCHS)) / EPOCHS, as_som(som)


def batch(untrained: Som, vectors: Array) -> tuple[float, Som]:
    training = BatchTraining(untrained, vectors, asymptotic(RADIUS, EPOCHS))

    def epochs() -> None:
        for _ in range(EPOCHS):
            training.run_epoch()

    return timed(epochs) / EPOCHS, training.som


def lookup(look: Callable[[Array], Any], frames: list[Array]) -> tuple[float, None]:
    """Time one call per frame."""
    return timed(lambda: [look(frame) for frame in frames]) / len(frames), None


def batched(som: Som, vectors: Array) -> tuple[float, None]:
    return timed(lambda: som.bmus(vectors)) / len(vectors), None


def lookups(start: Array, vectors: Array) -> Iterator[Row]:
    """Single frames one call each, and all vectors in one call where there is such a call."""
    one, many, winner = "best matching unit of one frame", "best matching units of many frames", minisom(start).winner
    theirs = partial(lookup, winner, list(vectors[:LOOKUPS]))
    yield Row(one, "MiniSom.winner", theirs)
    for name, dtype in DTYPES.items():
        frames = list(vectors[:LOOKUPS].astype(dtype))
        yield Row(one, name, partial(lookup, Som(SIDE, SIDE, start.astype(dtype)).bmu, frames))
    yield Row(many, "MiniSom.winner, a loop", theirs)
    for name, dtype in DTYPES.items():
        yield Row(many, name, partial(batched, Som(SIDE, SIDE, start.astype(dtype)), vectors.astype(dtype)))


def trainings(start: Array, vectors: Array) -> Iterator[Row]:
    """Everything that makes a map."""
    steps, epochs = f"sequential training, {STEPS:,} steps", f"batch training, {EPOCHS} epochs of {VECTORS:,}"
    untrained = {name: Som(SIDE, SIDE, start.astype(dtype)) for name, dtype in DTYPES.items()}
    yield Row(steps, "MiniSom", partial(minisom_sequential, start, vectors))
    in_numpy = partial(sequential, untrained["actum, float64"], vectors, adapt_in_numpy)
    yield Row(steps, "actum, float64, NumPy only", in_numpy)
    for name, som in untrained.items():
        yield Row(steps, name, partial(sequential, som, vectors, fastest_kernel()))
    yield Row(epochs, "MiniSom train_batch_offline", partial(minisom_batch, start, vectors))
    for name, som in untrained.items():
        yield Row(epochs, name, partial(batch, som, vectors.astype(DTYPES[name])))


def measured(dim: int) -> list[Row]:
    """Run everything in turn, round after round, after what is compiled has been compiled."""
    vectors = synthetic(dim)
    start = vectors[np.random.default_rng(1).choice(VECTORS, SIDE * SIDE, replace=False)]
    warm_up(start)
    rows = [*trainings(start, vectors), *lookups(start, vectors)]
    for _ in range(ROUNDS):
        for row in rows:
            time_us, row.som = row.run()
            row.times_us.append(time_us)
    return rows


def warm_up(start: Array) -> None:
    for dtype in DTYPES.values():
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
