"""What all methods have in common, and how their thresholds are chosen."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeVar

from actum_model_trainer.continuous.detections import Detection, Found, point_fractions
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous_cross_validation import with_points

from .streams import Fold, Stream

Thresholds = TypeVar("Thresholds")
Fitted = Callable[[Stream], list[Detection]]
"""A trained method: finds actions in a stream, causally."""

SEED = 0
INNER_FOLDS = 3
"""Into how many the training people are divided where thresholds are chosen."""
COST_OF_A_SECOND = 0.2
"""What a second of median latency costs in F1: without it, thresholds are chosen that wait for 1.5 s."""


class Method(NamedTuple):
    """Something to train: learns from streams, and chooses thresholds on them alone."""

    name: str
    fit: Callable[[tuple[Stream, ...]], Fitted]


def found(fitted: Fitted, fold: Fold) -> Found:
    """Ask a trained method about the test streams; action points lie where those of the training do."""
    fractions = point_fractions(truth for stream in fold.training for truth in stream.truths)
    return sum(
        (
            Found(with_points(fitted(stream), fractions), stream.truths, stream.seen)
            for stream in fold.test
        ),
        Found(),
    )  # fmt: skip


def inner_folds(training: Sequence[Stream]) -> list[set[int]]:
    """Divide the training people: each is left out once."""
    people = sorted({stream.person for stream in training})
    return [set(people[fold::INNER_FOLDS]) for fold in range(INNER_FOLDS)]


def chosen(
    grid: Iterable[Thresholds], streams: Sequence[Stream], detections: Callable[[Thresholds, Stream], list[Detection]]
) -> Thresholds:
    """Return the thresholds of a grid with the best merit on streams; the first of equals."""

    def merit_of(thresholds: Thresholds) -> float:
        own = [Found(detections(thresholds, stream), stream.truths, stream.seen) for stream in streams]
        return merit(sum(own, Found()))

    return max(grid, key=merit_of)


def merit(found: Found) -> float:
    """Return the mean of event F1 and F1 at IoU .5, less what the median latency costs."""
    scores = scores_of(found)
    late_s = scores.latency_s[0] if scores.latency_s else 0.0
    return (scores.event.f1 + scores.f1_at_iou[0.5]) / 2 - COST_OF_A_SECOND * max(late_s, 0.0)
