"""A peer: MiniRocket and a ridge on sliding windows, with an explicit none, thresholds, and suppression of the weaker.

The kernels' biases are drawn once from all training windows of a fold, so that each window is transformed once; the
ridge whose thresholds are chosen has not seen the people on whom they are chosen.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from aeon.transformations.collection.convolution_based import MiniRocket
from numpy.typing import NDArray
from sklearn.linear_model import RidgeClassifier, RidgeClassifierCV
from sklearn.preprocessing import StandardScaler

from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Detection

from .methods import SEED, Fitted, Method, chosen, inner_folds
from .streams import Stream
from .windows import NONE, Indices, Window, durations_s, sliding, training_windows

Floats = NDArray[np.float32]

INSTANTS = 32
CHUNK = 1000
"""Windows that are transformed at once: 40 MB of features."""
THRESHOLDS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2)
"""Of the margin of an action's decision value over none's; targets are −1 and 1."""
HOLDS_S = (0.1, 0.2, 0.3, 0.5)
"""How long an answer waits for a better one that overlaps it."""
OVERLAP = 0.25
"""The share of itself by which a later answer may reach into an earlier one."""
GRID = list(product(THRESHOLDS, HOLDS_S))


@dataclass(frozen=True)
class Scored:
    """The windows of a stream with their best actions.

    Attributes:
        ends: (steps,), frames.
        starts: (steps, durations), frames; −1 where there is no window.
        labels: (steps, durations), numbers of actions.
        margins: (steps, durations), over none; −∞ where there is no window.
    """

    ends: Indices
    starts: Indices
    labels: Indices
    margins: Floats


class Windows(NamedTuple):
    """Kernels, a ridge, and how long windows are."""

    kernels: Any
    scaler: StandardScaler
    ridge: Any
    lengths_s: NDArray[np.float64]


def fitted(training: Sequence[Stream]) -> Fitted:
    """Learn from windows, and choose thresholds on people left out."""
    windows = training_windows(training, np.random.default_rng(SEED))
    labels = np.array([window.label for window in windows])
    kernels = MiniRocket(random_state=SEED)
    features = np.asarray(kernels.fit_transform(inputs_of(windows)))
    scaler = StandardScaler(with_mean=False, copy=False)
    features = scaler.fit_transform(features)
    ridge = RidgeClassifierCV(alphas=np.logspace(-3, 3, 10)).fit(features, labels)
    own = Windows(kernels, scaler, ridge, durations_s(training))
    scored_by_others = dict(_left_out(own, training, windows, features, labels))
    classes = list(ridge.classes_)
    best = chosen(GRID, training, lambda each, stream: decoded(stream, scored_by_others[stream], classes, each))
    return lambda stream: decoded(stream, scored(own, stream), classes, best)


ROCKET_WINDOWS = Method("MiniRocket windows, an explicit none", fitted)


def _left_out(
    fitted: Windows, training: Sequence[Stream], windows: Sequence[Window], features: Floats, labels: Any
) -> Iterator[tuple[Stream, Scored]]:
    """Score each stream by a ridge that has not seen its person."""
    for people in inner_folds(training):
        others = np.array([window.stream.person not in people for window in windows])
        ridge = RidgeClassifier(alpha=fitted.ridge.alpha_).fit(features[others], labels[others])
        for stream in training:
            if stream.person in people:
                yield stream, scored(fitted._replace(ridge=ridge), stream)


def inputs_of(windows: Sequence[Window]) -> Floats:
    """Return windows resampled to even instants, (n, 45, INSTANTS)."""
    return np.concatenate(
        [resampled(each.stream, np.array([each.first]), np.array([each.last])) for each in windows]
    )  # fmt: skip


def resampled(stream: Stream, first: Indices, last: Indices) -> Floats:
    """Interpolate the frames between first (n,) and last (n,), (n, 45, INSTANTS); 0 for what was never seen."""
    at = first[:, None] + (last - first)[:, None] * np.linspace(0, 1, INSTANTS)
    before = np.minimum(at.astype(int), len(stream.rows) - 2)
    after = (at - before)[..., None].astype(np.float32)
    between = (1 - after) * stream.rows[before] + after * stream.rows[before + 1]
    return np.ascontiguousarray(between.transpose(0, 2, 1))


def scored(fitted: Windows, stream: Stream) -> Scored:
    """Give every window of a stream its best action and that one's margin over none."""
    ends, starts = sliding(stream, fitted.lengths_s)
    step, duration = np.nonzero(starts >= 0)
    labels = np.zeros(starts.shape, dtype=np.intp)
    margins = np.full(starts.shape, -np.inf, dtype=np.float32)
    none = list(fitted.ridge.classes_).index(NONE)
    for at in range(0, len(step), CHUNK):
        own = step[at : at + CHUNK], duration[at : at + CHUNK]
        features = fitted.scaler.transform(fitted.kernels.transform(resampled(stream, starts[own], ends[own[0]])))
        values = fitted.ridge.decision_function(features)
        over_none = values - values[:, [none]]
        over_none[:, none] = -np.inf
        labels[own], margins[own] = over_none.argmax(axis=1), over_none.max(axis=1)
    return Scored(ends, starts, labels, margins)


def decoded(stream: Stream, own: Scored, classes: Sequence[str], thresholds: tuple[float, float]) -> list[Detection]:
    """Answer with the best window once no better one that ends soon after has come."""
    threshold, hold_s = thresholds
    decide = partial(_decided, stream, classes)
    detections: list[Detection] = []
    best: tuple[float, int, int, int] | None = None
    free_from = 0
    for step, end in enumerate(own.ends.tolist()):
        if best and stream.stamps_ns[end] - stream.stamps_ns[best[2]] >= hold_s * SECOND_NS:
            detections.append(decide(best, end))
            free_from = best[2]
            best = None
        starts = own.starts[step]
        allowed = starts + OVERLAP * (end - starts) >= free_from
        margins = np.where(allowed, own.margins[step], -np.inf)
        duration = int(margins.argmax())
        if margins[duration] > max(threshold, best[0] if best else -np.inf):
            best = float(margins[duration]), int(starts[duration]), end, int(own.labels[step, duration])
    return [*detections, decide(best, len(stream.stamps_ns) - 1)] if best else detections


def _decided(
    stream: Stream, classes: Sequence[str], best: tuple[float, int, int, int], decided: int
) -> Detection:  # fmt: skip
    margin, first, last, label = best
    return stream.detection(first, last, decided, classes[label], margin)
