"""Which detection answers which truth, one to one.

Each detection claims the one truth of its file, agent and label that it fits best, and a truth takes the best of those
that claim it; all others are false. That is the segmental F1's matching (Lea, Flynn, Vidal, Reiter, Hager 2017). A
matching of largest size would give a detection that lost its truth a second choice: an answer that reaches into two
truths, given twice, would be right twice.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from operator import itemgetter

from actum_model_trainer.continuous.detections import Detection, Interval, Truth

Fit = Callable[[Detection, Truth], float | None]
"""How well a detection fits a truth of its label, the more the better; None where it does not at all."""


@dataclass(frozen=True)
class Match:
    """A truth and the detection that answers it.

    Attributes:
        fit: how well it does, as the matching's `Fit` defines it.
    """

    detection: Detection
    truth: Truth
    fit: float


def matched(detections: Iterable[Detection], truths: Iterable[Truth], fit: Fit) -> list[Match]:
    """Match detections with truths of the same file, agent and label, each at most once; the order counts for nothing.

    Of claims that fit alike the one that was decided first holds.
    """
    by_truth: defaultdict[Truth, list[Match]] = defaultdict(list)
    for claim in claims(detections, truths, fit):
        by_truth[claim.truth].append(claim)
    return [max(of_one, key=_rank) for of_one in by_truth.values()]


def claims(detections: Iterable[Detection], truths: Iterable[Truth], fit: Fit) -> Iterator[Match]:
    """Yield for each detection the truth that it claims, if it fits one; of those that it fits alike, the earliest."""
    same: defaultdict[tuple[str, int, str], list[Truth]] = defaultdict(list)
    for truth in sorted(truths, key=lambda truth: (truth.start_ns, truth.end_ns, truth.point_ns or 0)):
        same[truth.file, truth.agent, truth.label].append(truth)
    for detection in detections:
        alike = same[detection.file, detection.agent, detection.label]
        possible = [(value, truth) for truth in alike if (value := fit(detection, truth)) is not None]
        if possible:
            value, truth = max(possible, key=itemgetter(0))
            yield Match(detection, truth, value)


def overlap_ns(first: Interval, second: Interval) -> int:
    """Return the time that two intervals of the same file and agent have in common (ns), negative where it is none."""
    return min(first.end_ns, second.end_ns) - max(first.start_ns, second.start_ns)


def intersection_over_union(detection: Detection, truth: Truth) -> float | None:
    """Return the temporal overlap (IoU), 0 to 1; None where they have no time in common."""
    if detection.end_ns <= truth.start_ns or truth.end_ns <= detection.start_ns:
        return None  # nearly all are so far apart
    common_ns = overlap_ns(detection, truth)
    if common_ns <= 0:
        return None
    return common_ns / (max(detection.end_ns, truth.end_ns) - min(detection.start_ns, truth.start_ns))


def point_closeness(tolerance_ns: int) -> Fit:
    """Return the fit of action points: minus their distance (ns); None beyond the tolerance or without a point."""

    def fit(detection: Detection, truth: Truth) -> float | None:
        if truth.point_ns is None:
            return None
        distance_ns = abs(detection.claimed_point_ns - truth.point_ns)
        return -float(distance_ns) if distance_ns <= tolerance_ns else None

    return fit


def _rank(match: Match) -> tuple[float, int, int, int, float]:
    detection = match.detection
    return match.fit, -detection.decided_ns, -detection.start_ns, -detection.end_ns, detection.confidence
