"""Scores of what was found without marks: events, boundaries, action points, false detections, latency."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from statistics import median
from typing import Any, TypeVar

import numpy as np

from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Detection, Found, Interval, Stretch, Truth
from actum_model_trainer.continuous.matching import (
    Match,
    claims,
    intersection_over_union,
    matched,
    overlap_ns,
    point_closeness,
)

IOUS = (0.1, 0.25, 0.5)
"""Overlaps (IoU) at which F1 is given: the field's three, from found at all to well bounded."""
POINT_TOLERANCE_NS = 333_000_000
"""How far a claimed action point may be from the annotated one: ten frames, as MSRC-12 is scored."""
FALSE_ALARMS_PER_MIN = 1.0
"""The rate of false detections at which recall is given: about what people bear."""
MINUTE_NS = 60 * SECOND_NS
T = TypeVar("T", bound=Interval)


@dataclass(frozen=True)
class ActionScore:
    """The results for one action.

    Attributes:
        truths: how often it was done.
        detections: how often it was found, rightly or not.
        right: how many of these answer a truth, each one of its own.
    """

    truths: int
    detections: int
    right: int

    @property
    def precision(self) -> float:
        """The share of its detections that are right, 0 where there is none."""
        return self.right / self.detections if self.detections else 0.0

    @property
    def recall(self) -> float:
        """The share of its truths that were found, 0 where there is none."""
        return self.right / self.truths if self.truths else 0.0

    @property
    def f1(self) -> float:
        """The harmonic mean of both, 0 where there is neither truth nor detection."""
        return f1(self.right, self.detections, self.truths)

    def as_json(self) -> dict[str, Any]:
        """Return counts and scores as plain values for JSON."""
        counts = {"truths": self.truths, "detections": self.detections, "right": self.right}
        return counts | {"precision": self.precision, "recall": self.recall, "f1": self.f1}


@dataclass(frozen=True)
class EventScores:
    """Which events are found in all recordings together, and how many false ones: all that a threshold is chosen by.

    Attributes:
        event: of events: the right label, and some time in common with the truth it answers.
        f1_at_iou: F1 where the overlap (IoU) with that truth counts only from this on.
        false_detections: detections that answer no truth.
        background_min: the minutes in which somebody was seen and did none of the actions.
        false_per_min: false detections in a minute of background, wherever they lie; None without background.
        alarms_per_min: the same of those alone that have no time in common with any truth: they lie in the background.
    """

    event: ActionScore
    f1_at_iou: dict[float, float]
    false_detections: int
    background_min: float
    false_per_min: float | None
    alarms_per_min: float | None


@dataclass(frozen=True)
class ContinuousScores(EventScores):
    """The scores of all recordings together.

    Attributes:
        point_f1: F1 of action points within `POINT_TOLERANCE_NS`; None where no truth has one.
        latency_s: from a truth's end to the answer to it, seconds: median and 90th percentile; None without an answer.
        fragmentations: truths to which more than one detection belongs, by more than half of its length, whatever its
            label.
        merges: detections that hold more than half of each of several truths, whatever their labels.
        recall_at_rate: the largest recall at `FALSE_ALARMS_PER_MIN` or fewer, over all thresholds on sureness; None
            without background.
        per_action: the scores of each action, by label.
    """

    point_f1: float | None
    latency_s: tuple[float, float] | None
    fragmentations: int
    merges: int
    recall_at_rate: float | None
    per_action: dict[str, ActionScore]

    def as_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        median_s, ninth_decile_s = self.latency_s or (None, None)
        return {
            "event_f1": self.event.f1,
            "precision": self.event.precision,
            "recall": self.event.recall,
            "truths": self.event.truths,
            "detections": self.event.detections,
            "right": self.event.right,
            "f1_at_iou": {str(iou): value for iou, value in self.f1_at_iou.items()},
            "point_f1": self.point_f1,
            "false_detections": self.false_detections,
            "background_min": self.background_min,
            "false_per_min": self.false_per_min,
            "alarms_per_min": self.alarms_per_min,
            "latency_median_s": median_s,
            "latency_p90_s": ninth_decile_s,
            "fragmentations": self.fragmentations,
            "merges": self.merges,
            "recall_at_1_per_min": self.recall_at_rate,
            "per_action": {label: score.as_json() for label, score in self.per_action.items()},
        }


def event_scores(found: Found, minutes: float) -> EventScores:
    """Score which events were found; `minutes` is the `background_min` of what was seen and done."""
    detections, truths, fits = len(found.detections), len(found.truths), found.pairs.fits()
    false, in_background = detections - len(fits), detections - found.pairs.count(found.pairs.common_ns > 0)
    return EventScores(
        event=ActionScore(truths, detections, len(fits)),
        f1_at_iou={iou: f1(int((fits >= iou).sum()), detections, truths) for iou in IOUS},
        false_detections=false,
        background_min=minutes,
        false_per_min=false / minutes if minutes else None,
        alarms_per_min=in_background / minutes if minutes else None,
    )


def scores_of(found: Found) -> ContinuousScores:
    """Score what was found."""
    matches = matched(found.detections, found.truths, intersection_over_union)
    minutes = background_min(found.seen, found.truths)
    done, answered = _of_one_person(found.truths), _of_one_person(found.detections)
    return ContinuousScores(
        **vars(event_scores(found, minutes)),
        point_f1=point_f1(found.detections, found.truths),
        latency_s=latency_s(matches),
        fragmentations=_holding_several(found.truths, answered),
        merges=_holding_several(found.detections, done),
        recall_at_rate=_recall_at(FALSE_ALARMS_PER_MIN * minutes, found) if minutes else None,
        per_action=_per_action(found, matches),
    )


def f1(right: int, detections: int, truths: int) -> float:
    """Return the harmonic mean of precision and recall, 0 where there is neither detection nor truth."""
    return 2 * right / (detections + truths) if detections + truths else 0.0


def point_f1(detections: Sequence[Detection], truths: Sequence[Truth]) -> float | None:
    """Return the F1 of action points (Fothergill, Mentis, Kohli, Nowozin 2012); None where no truth has one.

    A detection is right where the point that it claims lies within 333 ms of that of a truth with its label. The point
    is not the instant of the decision: it lies within the segment found, at the fraction of its length at which those
    of the training recordings lie, or in the middle where nothing is known of these.
    """
    if all(truth.point_ns is None for truth in truths):
        return None
    right = len(matched(detections, truths, point_closeness(POINT_TOLERANCE_NS)))
    return f1(right, len(detections), len(truths))


def latency_s(matches: Sequence[Match]) -> tuple[float, float] | None:
    """Return median and 90th percentile of the time from a truth's end to the answer (s); None where none was given."""
    latencies_s = [(match.detection.decided_ns - match.truth.end_ns) / SECOND_NS for match in matches]
    return (median(latencies_s), float(np.quantile(latencies_s, 0.9))) if latencies_s else None


def background_min(seen: Iterable[Stretch], truths: Iterable[Truth]) -> float:
    """Return for how many minutes people were seen outside the truths, each person's time counted."""
    done = _of_one_person(truths)
    return sum(_outside_ns(stretch, done[stretch.file, stretch.agent]) for stretch in seen) / MINUTE_NS


def _outside_ns(stretch: Stretch, truths: Iterable[Truth]) -> int:
    reached_ns, outside_ns = stretch.start_ns, 0
    for truth in sorted(truths, key=lambda truth: truth.start_ns):
        outside_ns += max(0, min(truth.start_ns, stretch.end_ns) - reached_ns)
        reached_ns = max(reached_ns, truth.end_ns)
    return outside_ns + max(0, stretch.end_ns - reached_ns)


def _recall_at(most_false: float, found: Found) -> float:
    """Return the largest recall of all thresholds on sureness that leave at most so many false detections."""
    claimed = {
        claim.detection: claim.truth for claim in claims(found.detections, found.truths, intersection_over_union)
    }
    answered: set[Truth] = set()
    best = kept = 0
    surest_first = sorted(found.detections, key=lambda detection: -detection.sureness)
    for _, equally_sure in groupby(surest_first, key=lambda detection: detection.sureness):
        more = list(equally_sure)
        kept += len(more)
        answered.update(claimed[detection] for detection in more if detection in claimed)
        if kept - len(answered) <= most_false:
            best = len(answered)
    return best / len(found.truths) if found.truths else 0.0


def _of_one_person(intervals: Iterable[T]) -> defaultdict[tuple[str, int], list[T]]:
    of_person: defaultdict[tuple[str, int], list[T]] = defaultdict(list)
    for interval in intervals:
        of_person[interval.file, interval.agent].append(interval)
    return of_person


def _holding_several(outer: Iterable[Interval], of_person: Mapping[tuple[str, int], Sequence[Interval]]) -> int:
    """Count the intervals that hold more than half of each of several others of the same file and agent."""
    return sum(
        sum(2 * overlap_ns(each, other) > other.end_ns - other.start_ns for other in of_person[each.file, each.agent])
        > 1
        for each in outer
    )


def _per_action(found: Found, matches: Sequence[Match]) -> dict[str, ActionScore]:
    done = Counter(truth.label for truth in found.truths)
    answered = Counter(detection.label for detection in found.detections)
    right = Counter(match.truth.label for match in matches)
    return {label: ActionScore(done[label], answered[label], right[label]) for label in sorted(done | answered)}
