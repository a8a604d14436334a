"""The threshold of the search, chosen by what it finds in streams of people left out of the heads' training."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from actum_model_trainer.continuous.detections import Detection, Found
from actum_model_trainer.continuous.scoring import ContinuousScores, scores_of
from actum_model_trainer.spotting.scanning import ScannedStream
from som_classifier.kinematics import GAP_NS
from som_classifier.spotting.spotting_model import SpottingModel

BEARABLE_PER_MIN = 0.5
"""False alarms in a minute of background that cost nothing in the choice of the threshold."""
COST_PER_MIN = 0.1
"""What each further one costs, in units of F1."""
SHORTEST_BACKGROUND_MIN = 0.5
"""Minutes of background below which false alarms a minute are not counted: too few for a rate."""
IOU = 0.5
"""Overlap at which bounds count as right in that choice."""


@dataclass(frozen=True)
class ThresholdChoice:
    """What each threshold gives, and the best.

    Attributes:
        threshold: the best.
        worth: what it is worth.
        false_alarms_per_min: by threshold; empty where there is too little background.
        recalls: by threshold.
    """

    threshold: float
    worth: float
    false_alarms_per_min: list[float]
    recalls: list[float]

    @property
    def stored(self) -> dict[str, Any]:
        """What of it the model's metadata hold."""
        return {name: value for name, value in asdict(self).items() if name != "worth"}


def chosen_threshold(
    scanned: Sequence[ScannedStream], learned: SpottingModel, labels: Sequence[str], thresholds: Sequence[float]
) -> ThresholdChoice:
    """Search the streams with each threshold, and choose the best after smoothing over neighbouring ones."""
    scores = [scores_of(found(scanned, learned, labels, threshold)) for threshold in thresholds]
    worth = np.array([_worth(score) for score in scores])
    smoothed = np.convolve(np.pad(worth, 1, mode="edge"), np.full(3, 1 / 3), mode="valid")
    counted = scores[0].background_min >= SHORTEST_BACKGROUND_MIN
    rates = [score.alarms_per_min or 0.0 for score in scores] if counted else []
    return ThresholdChoice(
        float(thresholds[int(smoothed.argmax())]),
        float(smoothed.max()),
        np.minimum.accumulate(rates).tolist() if rates else [],
        [score.event.recall for score in scores],
    )


def found(scanned: Sequence[ScannedStream], learned: SpottingModel, labels: Sequence[str], threshold: float) -> Found:
    """Return what a search with this threshold finds in the streams."""
    detections = [
        Detection(each.stream.file, each.stream.agent, start_ns, end_ns, decided_ns, labels[action], 1.0)
        for each in scanned
        for start_ns, end_ns, decided_ns, action in _decided(each, learned, threshold)
    ]
    return replace(sum((each.stream.marked for each in scanned), Found()), detections=detections)


def false_alarms(
    scanned: Sequence[ScannedStream], learned: SpottingModel, labels: Sequence[str], threshold: float
) -> list[list[Detection]]:
    """Return for each stream what a search with this threshold finds where no action is done."""
    alarms = []
    for each in scanned:
        detections = found([each], learned, labels, threshold).detections
        segments = each.stream.segments
        alarms.append(
            [
                own
                for own in detections
                if not any(own.start_ns < end and start < own.end_ns for start, end, _ in segments)
            ]
        )
    return alarms


def _decided(each: ScannedStream, learned: SpottingModel, threshold: float) -> list[tuple[int, int, int, int]]:
    """Return start, end and decision (ns) and the action of each segment found in a stream."""
    decoder, stamps_ns = learned.decoder(), each.stream.stamps_ns
    starts_ns, ends_ns = stamps_ns[each.windows[:, 0]], stamps_ns[each.windows[:, 1]]
    candidates = learned.candidates(starts_ns, ends_ns, each.completeness, threshold)
    by_end = {end_ns: list(of_end) for end_ns, of_end in groupby(candidates, key=lambda each: each.end_ns)}
    gaps = np.flatnonzero(np.diff(stamps_ns) > GAP_NS) + 1
    decisions_ns = np.union1d(ends_ns, stamps_ns[gaps])
    restarts_ns = set(stamps_ns[gaps].tolist())
    decided = []
    for now_ns in decisions_ns.tolist():
        if now_ns in restarts_ns:
            decoder.forget()
        found_now = decoder.step(now_ns, by_end.get(now_ns, ()))
        decided += [(segment.start_ns, segment.end_ns, now_ns, segment.action) for segment in found_now]
    return decided


def _worth(score: ContinuousScores) -> float:
    false = 0.0
    if score.background_min >= SHORTEST_BACKGROUND_MIN and score.alarms_per_min is not None:
        false = max(score.alarms_per_min - BEARABLE_PER_MIN, 0.0)
    return score.event.f1 + score.f1_at_iou[IOU] - COST_PER_MIN * false
