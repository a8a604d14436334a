"""The threshold of the search, chosen by what it finds in streams of people left out of the heads' training."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Mask
from actum_model_trainer.continuous.detections import Detection, Found
from actum_model_trainer.continuous.scoring import EventScores, background_min, event_scores
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.scanning import ScannedStream
from som_classifier.kinematics import GAP_NS
from som_classifier.presets import Prior
from som_classifier.spotting.decoding import Decoder, decoded
from som_classifier.spotting.spotting_model import JudgedWindows, SpottingModel

BEARABLE_PER_MIN = 0.5
"""False alarms in a minute of background that cost nothing in the choice of the threshold."""
COST_PER_MIN = 0.1
"""What each further one costs, in units of F1."""
SHORTEST_BACKGROUND_MIN = 0.5
"""Minutes of background below which false alarms a minute are not counted: too few for a rate."""
IOU = 0.5
"""Overlap at which bounds count as right in that choice."""
COMMON_SHARE = 0.5
"""Of the shorter of a segment found and an action: from this on the action is done in it."""


@dataclass(frozen=True)
class ThresholdChoice:
    """What each threshold gives, and the best.

    Attributes:
        threshold: the best.
        worth: what it is worth.
        false_alarms_per_min: by threshold; empty where there is too little background.
        recalls: by threshold.
        precisions: share of what is found in which any action is done, by threshold.
    """

    threshold: float
    worth: float
    false_alarms_per_min: list[float]
    recalls: list[float]
    precisions: list[float]

    @property
    def stored(self) -> dict[str, Any]:
        """What of it the model's metadata hold."""
        return {name: value for name, value in asdict(self).items() if name != "worth"}


def chosen_threshold(
    scanned: Sequence[ScannedStream],
    learned: SpottingModel,
    labels: Sequence[str],
    thresholds: Sequence[float],
    prior: Prior,
) -> ThresholdChoice:
    """Search the streams with each threshold, and choose the best after smoothing over neighbouring ones."""
    judged = [Judged.of(each, learned) for each in scanned]
    marked = Found.of_all(each.stream.marked for each in judged)
    minutes = background_min(marked.seen, marked.truths)
    by_threshold = (replace(marked, detections=found(judged, learned, labels, each)) for each in thresholds)
    scores, precisions = zip(
        *((event_scores(own, minutes), precision(own, prior)) for own in by_threshold), strict=True
    )
    worth = np.array([worth_of(score) for score in scores])
    smoothed = np.convolve(np.pad(worth, 1, mode="edge"), np.full(3, 1 / 3), mode="valid")
    counted = minutes >= SHORTEST_BACKGROUND_MIN
    rates = [score.alarms_per_min or 0.0 for score in scores] if counted else []
    return ThresholdChoice(
        float(thresholds[int(smoothed.argmax())]),
        float(smoothed.max()),
        np.minimum.accumulate(rates).tolist() if rates else [],
        [score.event.recall for score in scores],
        list(precisions),
    )


def precision(of: Found, prior: Prior) -> float:
    """Return the share of what was found in which any action is done, as if the prior's segments had been found, too.

    What the action is called counts for nothing: how often that is right, the verifier knows.
    """
    pairs = of.pairs
    done = pairs.count(pairs.common_ns >= COMMON_SHARE * pairs.durations_ns.min(axis=1))
    return (done + prior.precision_segments * prior.precision) / (len(of.detections) + prior.precision_segments)


@dataclass(frozen=True, eq=False)
class Judged:
    """A stream, what each of its windows is most likely to be, and when a search decides.

    Attributes:
        stream: with its labelled segments.
        windows: in the order of their ends.
        decisions_ns: (k,), rising, the ends, and the stamps after gaps, at which a search begins anew.
        restarts: (k,), which of them are the latter.
    """

    stream: LabelledStream
    windows: JudgedWindows
    decisions_ns: NDArray[np.int64]
    restarts: Mask

    @classmethod
    def of(cls, scanned: ScannedStream, learned: SpottingModel) -> "Judged":
        """Judge the windows of a stream."""
        stamps_ns = scanned.stream.stamps_ns
        starts_ns, ends_ns = stamps_ns[scanned.windows[:, 0]], stamps_ns[scanned.windows[:, 1]]
        restarts_ns = stamps_ns[np.flatnonzero(np.diff(stamps_ns) > GAP_NS) + 1]
        windows = learned.judged(starts_ns, ends_ns, scanned.completeness)
        decisions_ns = np.union1d(ends_ns, restarts_ns)
        return cls(scanned.stream, windows, decisions_ns, np.isin(decisions_ns, restarts_ns))

    def decided(self, decoder: Decoder, threshold: float) -> list[tuple[int, int, int, int]]:
        """Return start, end and decision (ns) and the action of each segment that a search finds."""
        numbers, spans = self.windows.gainful(threshold)
        return [
            (
                each.start_ns,
                int(spans.ends_ns[each.candidate]),
                each.decided_ns,
                int(self.windows.actions[numbers[each.candidate]]),
            )
            for each in decoded(decoder, spans, self.decisions_ns, self.restarts)
        ]


def found(judged: Sequence[Judged], learned: SpottingModel, labels: Sequence[str], threshold: float) -> list[Detection]:
    """Return what a search with this threshold finds in the streams."""
    return [
        Detection(each.stream.file, each.stream.agent, start_ns, end_ns, decided_ns, labels[action], 1.0)
        for each in judged
        for start_ns, end_ns, decided_ns, action in each.decided(learned.decoder(), threshold)
    ]


def false_alarms(
    scanned: Sequence[ScannedStream], learned: SpottingModel, labels: Sequence[str], threshold: float
) -> list[list[Detection]]:
    """Return for each stream what a search with this threshold finds where no action is done."""
    alarms = []
    for each in scanned:
        detections = found([Judged.of(each, learned)], learned, labels, threshold)
        segments = each.stream.segments
        alarms.append(
            [
                own
                for own in detections
                if not any(own.start_ns < end and start < own.end_ns for start, end, _ in segments)
            ]
        )
    return alarms


def worth_of(score: EventScores) -> float:
    """Return what a search is worth: F1 twice, of events and of overlaps, less the cost of false alarms."""
    false = 0.0
    if score.background_min >= SHORTEST_BACKGROUND_MIN and score.alarms_per_min is not None:
        false = max(score.alarms_per_min - BEARABLE_PER_MIN, 0.0)
    return score.event.f1 + score.f1_at_iou[IOU] - COST_PER_MIN * false
