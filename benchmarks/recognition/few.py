"""Learning curves: a few examples of each action, from one person and from two."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.calibration_error import calibration_error, confidence_bins
from som_classifier.pyramid_model import PyramidModel

from .bench import Bench
from .datasets import Example
from .development import development_sets, said_of_videos
from .ours import OURS
from .peers import DTW, MINIROCKET, MINIROCKET_UPRIGHT, Recogniser
from .scores import Difference, Floats, Score, percent, table
from .splits import FEW_DRAWS, FEW_TESTED, FewExamples, few_examples

PEERS: tuple[Recogniser, ...] = (DTW, MINIROCKET, MINIROCKET_UPRIGHT)
COUNTS = (1, 2, 3, 5, 10)
PEOPLE = (1, 2)
HEADER = (OURS.name, *(peer.name for peer in PEERS), "minus best peer", "axes alone", "ECE")
Curve = dict[tuple[int, int], "Point"]


@dataclass
class Point:
    """What the draws gave at one number of people and of examples; `shares` has ours first, then the peers."""

    shares: list[list[float]] = field(default_factory=list)
    by_axes: list[float] = field(default_factory=list)
    confidences: list[float] = field(default_factory=list)
    right: list[bool] = field(default_factory=list)

    @property
    def means(self) -> Floats:
        return np.mean(self.shares, axis=0)

    @property
    def calibration_error(self) -> float:
        return calibration_error(confidence_bins(self.confidences, self.right))

    def gap(self, peer: int) -> Difference:
        """Return ours minus a peer's, by draw."""
        shares = np.array(self.shares)
        return Difference(shares[:, 0] - shares[:, peer])

    def add(self, training: Sequence[Example], test: Sequence[Example]) -> None:
        """Train all on a draw's sequences, and test them."""
        model = OURS.fit(training).model
        assert isinstance(model, PyramidModel)
        frames = [encoded(model, example.sample) for example in test]
        answers = [answer(model, own) for own in frames]
        whole = model.stages.weights(0.0, complete=True)
        winners = [model.scores([frame.activity for frame in own], whole).argmax() for own in frames]
        self.by_axes.append(Score.of([model.labels[winner] for winner in winners], test).share)
        self.confidences += [own.confidence for own in answers]
        labels = [own.label for own in answers]
        self.right += [label == example.label for label, example in zip(labels, test, strict=True)]
        peers = (peer.fit(training).labels(test) for peer in PEERS)
        self.shares.append([Score.of(own, test).share for own in (labels, *peers)])


def few(bench: Bench) -> Iterator[str]:
    """Accuracy against the number of examples."""
    sets = development_sets(bench.data)
    yield f"""Learnt from so many people (first number) and so many examples of each action and person (second),
tested on everybody but the two people of the draw, on at most {FEW_TESTED} sequences drawn once a draw.
{FEW_DRAWS} draws of people of whom there is every action, each first in turn; fewer examples are the first of more, and
one person the first of two. Where people have fewer examples they give what they have; a dash stands where that is what
the row before had.{said_of_videos()} Mean accuracy (%) over the draws; ours minus the peer with the highest
mean in that row, in points ± the standard error of the paired draws (as if they were independent). Axes alone: how
often the largest score on our discriminant axes is right, without the map of actions and the third layer. ECE: of our
confidence, all draws pooled."""
    curves = []
    for each in sets:
        curves.append(curve := _curve(list(few_examples(each.examples, each.of_few))))
        rows = (_row(people, count, curve.get((people, count))) for people in PEOPLE for count in COUNTS)
        yield table((each.name, *HEADER), rows)
    yield """The mean over the sets; one that has no more examples takes part with what it gave before. The best peer is
that with the highest mean over the sets."""
    yield table(("mean over sets", *HEADER), (_mean_row(p, count, curves) for p in PEOPLE for count in COUNTS))


def _curve(draws: Sequence[FewExamples]) -> Curve:
    """Measure each point whose sequences are not all those of the point before."""
    curve: Curve = {}
    for people in PEOPLE:
        for before, count in zip((0, *COUNTS), COUNTS, strict=False):
            if any(draw.training(people, count) != draw.training(people, before) for draw in draws):
                curve[people, count] = Point()
                for draw in draws:
                    curve[people, count].add(draw.training(people, count), draw.test)
    return curve


def _row(people: int, count: int, point: Point | None) -> list[str]:
    if point is None:
        return [f"{people} × {count}", *["–"] * len(HEADER)]
    return [f"{people} × {count}", *_cells([point])]


def _mean_row(people: int, count: int, curves: Sequence[Curve]) -> list[str]:
    if all((people, count) not in curve for curve in curves):
        return _row(people, count, None)
    return [f"{people} × {count}", *_cells([_latest(curve, people, count) for curve in curves])]


def _latest(curve: Curve, people: int, count: int) -> Point:
    return curve[people, max(own for of, own in curve if of == people and own <= count)]


def _cells(points: Sequence[Point]) -> list[str]:
    """Write the mean over the sets' points."""
    means = np.mean([point.means for point in points], axis=0)
    peer = 1 + int(means[1:].argmax())
    gaps = [point.gap(peer) for point in points]
    error = float(np.sqrt(sum(gap.standard_error**2 for gap in gaps))) / len(gaps)
    gap = f"{100 * np.mean([gap.mean for gap in gaps]):+.1f} ± {100 * error:.1f}"
    axes = percent(float(np.mean([np.mean(point.by_axes) for point in points])))
    ece = f"{np.mean([point.calibration_error for point in points]):.3f}"
    return [*(percent(mean) for mean in means), gap, axes, ece]
