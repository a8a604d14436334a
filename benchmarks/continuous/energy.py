"""A peer: segments where a body moves, by two thresholds on its speed, then our classifier."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum_model_trainer.answering import encoded
from actum_model_trainer.continuous.detections import Detection
from som_classifier.kinematics import LAG_TIME_CONSTANT_S
from som_classifier.model import Model

from .methods import Method, chosen
from .ours import ModelOf
from .streams import Stream

SMOOTHED_S = (0.17, 0.5)
"""Time over which speed is averaged, towards the past: five frames, or enough to bridge an action's turning points."""
STARTS = (0.25, 0.35, 0.5, 0.7, 1.0, 1.4)
"""Speed from which a segment starts, in units of the median speed within the training's truths."""
STOPS = (0.5, 0.75, 0.9)
"""Speed below which it may end, as a share of that from which it starts."""
QUIET_S = (0.1, 0.2, 0.35, 0.6)
"""How long the speed stays below before it has ended."""
GRID = list(product(STARTS, STOPS, QUIET_S, SMOOTHED_S))
ANY = "any"
"""Every action's label where only bounds count."""
SHORTEST = 0.5
"""Segments are at least so long, in units of the 4 % quantile of the training's durations."""


@dataclass(frozen=True)
class Hysteresis:
    """When a segment starts and ends.

    Attributes:
        start_m_s: speed from which it starts.
        stop_m_s: speed below which it may end.
        quiet_s: how long the speed stays below before it has.
        shortest_s: how long it is at least.
        smoothed_s: how long speed is averaged over.
    """

    start_m_s: float
    stop_m_s: float
    quiet_s: float
    shortest_s: float
    smoothed_s: float

    def segments(self, stream: Stream) -> list[tuple[int, int, int]]:
        """Return first and last frame of each segment, and the frame at which it was known to have ended."""
        speeds, stamps_ns = speeds_m_s(stream, self.smoothed_s), stream.stamps_ns
        segments, first, last = [], None, 0
        for i, speed in enumerate(speeds.tolist()):
            if first is None:
                first, last = (i, i) if speed >= self.start_m_s else (None, last)
            elif speed >= self.stop_m_s:
                last = i
            elif stamps_ns[i] - stamps_ns[last] >= self.quiet_s * SECOND_NS:
                segments.append((first, last, i))
                first = None
        return [each for each in segments if stamps_ns[each[1]] - stamps_ns[each[0]] >= self.shortest_s * SECOND_NS]


def energy(model_of: ModelOf) -> Method:
    """Return two thresholds on speed, chosen by the segments' bounds alone, without labels; then our classifier."""
    return Method(
        "energy, then our classifier",
        lambda training: partial(answered, chosen_hysteresis(training), model_of(training)),
    )


def chosen_hysteresis(training: Sequence[Stream]) -> Hysteresis:
    """Choose the thresholds by the bounds in streams."""
    usual_m_s = np.median(np.concatenate([_speeds_within(stream) for stream in training]))
    lengths_s = [(truth.end_ns - truth.start_ns) / SECOND_NS for stream in training for truth in stream.truths]
    shortest_s = SHORTEST * float(np.quantile(lengths_s, 0.04))
    grid = [
        Hysteresis(start * usual_m_s, stop * start * usual_m_s, quiet_s, shortest_s, smoothed_s)
        for start, stop, quiet_s, smoothed_s in GRID
    ]  # fmt: skip
    unnamed = [replace(own, truths=[replace(truth, label=ANY) for truth in own.truths]) for own in training]
    return chosen(
        grid, unnamed, lambda each, stream: [stream.detection(*span, ANY, 1.0) for span in each.segments(stream)]
    )


def answered(hysteresis: Hysteresis, model: Model, stream: Stream) -> list[Detection]:
    """Answer each segment; what the classifier calls unknown is none."""
    frames = encoded(model, stream.whole)
    detections = []
    for first, last, decided in hysteresis.segments(stream):
        if last - first + 1 >= model.min_frames:
            answer = model.recognise(frames[first : last + 1], complete=True)
            if not answer.unknown:
                detections.append(stream.answered(first, last, decided, answer))
    return detections


def speeds_m_s(stream: Stream, smoothed_s: float) -> NDArray[np.float64]:
    """Return the joints' mean speed at each frame (n,), averaged over the time before it."""
    speeds = np.nanmean(np.linalg.norm(stream.whole.velocities, axis=2), axis=1) / LAG_TIME_CONSTANT_S
    sums = np.concatenate([np.zeros(1), np.cumsum(speeds)])
    frames = np.arange(len(speeds))
    since = np.minimum(frames, np.searchsorted(stream.stamps_ns, stream.stamps_ns - round(smoothed_s * SECOND_NS)))
    averaged: NDArray[np.float64] = (sums[frames + 1] - sums[since]) / (frames + 1 - since)
    return averaged


def _speeds_within(stream: Stream) -> NDArray[np.float64]:
    speeds = speeds_m_s(stream, SMOOTHED_S[0])
    bounds = [stream.frames_of(truth) for truth in stream.truths]
    return np.concatenate([np.zeros(0), *(speeds[first : last + 1] for first, last in bounds)])
