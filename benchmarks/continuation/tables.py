"""Tables of errors by set and horizon, and what continuations cost."""

import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benchmarks.recognition.scores import table
from numpy.typing import NDArray

from actum_model_trainer.continuation_data import fitted_shares, instants_of
from actum_model_trainer.training import train, with_continuation
from som_classifier.continuation import HORIZONS_S
from som_classifier.model import Model
from som_classifier.presets import DEFAULT, PAPER, Preset

from .data import Sets, postures_of
from .errors import BASELINES, KEPT, Predict, Truth, as_measured, as_smoothed, errors_of, predicting
from .publishing import published_ms

BETWEEN = "without map or regression"
"""The posture stays between smoothed and measured, or beyond: what the shares of a continuation do alone."""
PRESETS: Mapping[str, Preset] = {"A-SOM, preset `paper`": PAPER, f"regression, preset `{DEFAULT.name}`": DEFAULT}
CALLS = 300
"""Calls of which the fastest hundredth is reported: others use the cores, too."""
COSTLY = "UTKinect"
"""The set whose models' cost is reported."""


@dataclass(frozen=True)
class Trained:
    """A model with a continuation, and how long each part of its training took (s)."""

    model: Model
    training_s: float
    continuation_s: float


class Bench:
    """The sets, and the models that were trained on each."""

    def __init__(self, folder: Path) -> None:
        self.sets = Sets(folder)
        self._trained: dict[tuple[str, str], Trained] = {}
        self._shares: dict[str, NDArray[np.float32]] = {}

    def trained(self, name: str, preset: Preset) -> Trained:
        """Return a model of a set's training people, trained when first asked for."""
        if (name, preset.name) not in self._trained:
            taught, began_s = self.sets.divided(name).taught, time.perf_counter()
            model = train(taught.usable, preset)
            trained_s = time.perf_counter()
            continued = with_continuation(model, taught.streams)
            times_s = trained_s - began_s, time.perf_counter() - trained_s
            self._trained[name, preset.name] = Trained(continued, *times_s)
        return self._trained[name, preset.name]

    def between(self, name: str) -> Predict:
        """Return what predicts no displacement, with shares that are fitted to a set's training people."""
        if name not in self._shares:
            instants = instants_of(self.sets.divided(name).taught.streams)
            self._shares[name] = fitted_shares(instants, np.zeros_like(instants.later))[1]
        removed = self._shares[name][:, None, None]
        return lambda frames: as_smoothed(frames[-1]) + removed * (as_measured(frames[-1]) - as_smoothed(frames[-1]))

    def errors_m(self, name: str, truth: Truth) -> dict[str, NDArray[np.float64]]:
        """Return the errors (people, 3) of each prediction on a set's tested people."""
        found: dict[str, list[NDArray[np.float64]]] = {}
        for streams in self.sets.divided(name).tested.values():
            for title, predict in BASELINES.items():
                found.setdefault(title, []).append(errors_of(predict, streams, truth))
            found.setdefault(BETWEEN, []).append(errors_of(self.between(name), streams, truth))
            for title, preset in PRESETS.items():
                predict = predicting(self.trained(name, preset).model, streams)
                found.setdefault(title, []).append(errors_of(predict, streams, truth))
        return {title: np.stack(found[title]) for title in (*PRESETS, BETWEEN, *BASELINES)}


def measured(bench: Bench) -> Iterator[str]:
    """Errors from postures as measured later."""
    yield """The truth is the posture as the preprocessor publishes it later, before the classifier smooths it. The mean
distance of the 15 joints in millimetres ± its standard deviation over people; in brackets the number of people on whom
it is below all three assumptions. Both continuations start between the posture as smoothed and as measured, or beyond
the latter, as is best on the training people; *without map or regression* is that alone."""
    yield _table(bench, as_measured)


def smoothed(bench: Bench) -> Iterator[str]:
    """Errors from postures as smoothed later."""
    yield """The same models; the truth is the posture that the classifier will have smoothed, which lags behind what is
measured."""
    yield _table(bench, as_smoothed)


def _table(bench: Bench, truth: Truth) -> str:
    rows = [row for name in bench.sets.names for row in _rows(name, bench.errors_m(name, truth))]
    return table(("set, people", "ahead", *PRESETS, BETWEEN, *BASELINES), rows)


def _rows(name: str, errors_m: Mapping[str, NDArray[np.float64]]) -> Iterator[list[str]]:
    best = np.min([errors_m[title] for title in BASELINES], axis=0)
    for horizon, horizon_s in enumerate(HORIZONS_S):
        cells = []
        for title, of_people in errors_m.items():
            errors_mm = 1000 * of_people[:, horizon]
            below = f" ({int((of_people < best)[:, horizon].sum())})" if title in PRESETS else ""
            cells.append(f"{errors_mm.mean():.1f} ± {errors_mm.std():.1f}{below}")
        yield [f"{name}, {len(best)}", f"{horizon_s:g} s", *cells]


def cost(bench: Bench) -> Iterator[str]:
    """What a continuation costs."""
    yield f"""Models of {COSTLY}, one core that is shared with other work. A call takes as long as the fastest hundredth
of {CALLS} calls. *Published*: how much longer the classifier takes for a posture while somebody subscribes to
continuations, on average and in the slowest hundredth: call, message and bytes, in a recording of a tested person."""
    postures, rows = postures_of(bench.sets.divided(COSTLY).recordings[0]), []
    for title, preset in PRESETS.items():
        trained = bench.trained(COSTLY, preset)
        took = f"{trained.training_s:.1f}", f"{trained.continuation_s:.1f}"
        published = [f"{each:.2f}" for each in published_ms(trained.model, postures)]
        rows.append([title, f"{_call_ms(bench, trained.model):.3f}", *published, *took, *_sizes_mb(trained.model)])
    header = (
        "continuation",
        "a call, ms",
        "published, ms",
        "slowest hundredth, ms",
        "training without it, s",
        "its training, s",
        "file without it, MB",
        "with it, MB",
    )
    yield table(header, rows)


def _call_ms(bench: Bench, model: Model) -> float:
    streams = next(iter(bench.sets.divided(COSTLY).tested.values()))
    predict, frames, times_s = predicting(model, streams), streams[0][:KEPT], []
    for _ in range(CALLS):
        began_s = time.perf_counter()
        predict(frames)
        times_s.append(time.perf_counter() - began_s)
    return 1000 * float(np.quantile(times_s, 0.01))


def _sizes_mb(model: Model) -> tuple[str, str]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.npz"
        model.save(path)
        size = path.stat().st_size
    assert model.continuation is not None
    own = sum(array.nbytes for array in model.continuation.arrays.values())
    return f"{(size - own) / 1e6:.1f}", f"{size / 1e6:.1f}"
