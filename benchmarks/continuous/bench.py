"""What all parts share: the sets, every method, and what has been trained on each fold."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from benchmarks.recognition.scores import table

from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import ContinuousScores, scores_of

from .energy import energy
from .methods import found
from .ours import ModelOf, bound, ours, trained
from .rocket_windows import ROCKET_WINDOWS
from .streams import ContinuousSets, Fold

EVENTS, HALF, POINTS = "events F1", "F1@.5", "action points F1"
FALSE, LATENCY = "false / min (in background)", "latency, s: median (90 %)"
HEADER = ("method", EVENTS, "F1@.1", "F1@.25", HALF, FALSE, LATENCY, "recall at 1 false / min", "split, merged")
Goals = Mapping[str, Mapping[str, str]]
"""Rows below the methods: what ours is to reach, by column."""
NO_GOALS: Goals = {}


class Bench:
    """The sets, and what has been trained on them."""

    def __init__(self, data: ContinuousSets, model_of: ModelOf = trained) -> None:
        self.data = data
        self.model_of: ModelOf = cache(model_of)
        self._methods = ours(self.model_of), ROCKET_WINDOWS, energy(self.model_of), bound(self.model_of)
        self._fitted = cache(lambda method, training: method.fit(training))

    def found(self, folds: Sequence[Fold]) -> dict[str, Found]:
        """Ask ours, its peers and the bound about the test streams of every fold; pool what each finds, by its name."""
        pooled = {method.name: Found() for method in self._methods}
        for fold in folds:
            for method in self._methods:
                pooled[method.name] += found(self._fitted(method, fold.training), fold)
        return pooled


def scores_table(pooled: dict[str, Found], goals: Goals = NO_GOALS) -> str:
    """Tabulate the scores of each method, and below them what ours is to reach."""
    scores = {name: scores_of(own) for name, own in pooled.items()}
    with_points = any(own.point_f1 is not None for own in scores.values())
    header = [*HEADER, POINTS] if with_points else HEADER
    rows = [[name, *_cells(own)] for name, own in scores.items()]
    wanted = [[f"*{name}*", *(of.get(column, "") for column in header[1:])] for name, of in goals.items()]
    return table(header, [*rows, *wanted])


def _cells(scores: ContinuousScores) -> Iterator[str]:
    yield share(scores.event.f1)
    yield from (share(value) for value in scores.f1_at_iou.values())
    yield f"{number(scores.false_per_min)} ({number(scores.alarms_per_min)})"
    median_s, ninth_decile_s = scores.latency_s or (None, None)
    yield f"{number(median_s)} ({number(ninth_decile_s)})"
    yield "–" if scores.recall_at_rate is None else share(scores.recall_at_rate)
    yield f"{scores.fragmentations}, {scores.merges}"
    if scores.point_f1 is not None:
        yield share(scores.point_f1)


def share(value: float) -> str:
    """Write a share with three digits."""
    return f"{value:.3f}"


def number(value: float | None) -> str:
    """Write a number with two digits; a dash where there is none."""
    return "–" if value is None else f"{value:.2f}"
