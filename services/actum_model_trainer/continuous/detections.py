"""What was found in recordings without marks, what was done in them, and when anybody was seen; as JSON."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from statistics import median_high
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices, Mask


@dataclass(frozen=True)
class Interval:
    """A span of one person's time.

    Attributes:
        file: the recording's path; with the sensor behind it where the recording holds several.
        agent: whose time it is; 0 for an action that was done while nobody was seen.
        start_ns: stamp of its first frame.
        end_ns: stamp of its last frame, which belongs to it.
    """

    file: str
    agent: int
    start_ns: int
    end_ns: int


@dataclass(frozen=True)
class Detection(Interval):
    """An action that was found.

    Attributes:
        decided_ns: stamp of the newest posture when the answer came.
        confidence: of the label, 0 to 1.
        point_ns: the action point that it claims, a single instant of the action; None for its middle.
        familiarity: the probability that this is a true instance of the label, as the classifier publishes it; None
            where the confidence says that.
    """

    decided_ns: int
    label: str
    confidence: float
    point_ns: int | None = None
    familiarity: float | None = None

    @property
    def sureness(self) -> float:
        """By what detections are ranked: familiarity if there is one, otherwise confidence.

        Our confidence is the probability of the label if an action was done at all, so it ranks no false alarms.
        """
        return self.confidence if self.familiarity is None else self.familiarity

    @property
    def claimed_point_ns(self) -> int:
        """The action point that it claims."""
        return (self.start_ns + self.end_ns) // 2 if self.point_ns is None else self.point_ns


@dataclass(frozen=True)
class Truth(Interval):
    """An action that was done.

    Attributes:
        point_ns: its annotated action point, the instant at which it can be recognised; None where there is none.
    """

    label: str
    point_ns: int | None = None


class Stretch(Interval):
    """A time in which a person was seen without a longer break."""


class Pairs(NamedTuple):
    """All n pairs of a detection and a truth of the same file and agent.

    Attributes:
        detections: (n,), the number of each detection, rising.
        truths: (n,), the number of each truth in the order of starts, rising among those of a detection.
        alike: (n,), whether both have the same label.
        common_ns: (n,), the time that both have in common, negative where it is none.
        durations_ns: (n, 2), how long the detection and the truth last.
    """

    detections: Indices
    truths: Indices
    alike: Mask
    common_ns: NDArray[np.int64]
    durations_ns: NDArray[np.int64]

    @classmethod
    def of(cls, detections: Sequence[Detection], truths: Sequence[Truth]) -> "Pairs":
        """Pair everything that was found with everything that its person did."""
        done = sorted(truths, key=lambda truth: (truth.start_ns, truth.end_ns, truth.point_ns or 0))
        owners, bounds_ns, labels = _columns(detections)
        doers, done_ns, done_labels = _columns(done)
        numbers: dict[tuple[str, int], list[int]] = {}
        for number, doer in enumerate(doers):
            numbers.setdefault(doer, []).append(number)
        beside = [numbers.get(owner, []) for owner in owners]
        rows = np.repeat(np.arange(len(beside)), [len(each) for each in beside])
        columns = np.array([number for each in beside for number in each], np.intp)
        one, other = bounds_ns[rows], done_ns[columns]
        common_ns = np.minimum(one[:, 1], other[:, 1]) - np.maximum(one[:, 0], other[:, 0])
        durations_ns = np.stack([one[:, 1] - one[:, 0], other[:, 1] - other[:, 0]], axis=1)
        return cls(rows, columns, labels[rows] == done_labels[columns], common_ns, durations_ns)

    def fits(self) -> Array:
        """Return the overlap (IoU) of each match that `matched` makes by `intersection_over_union`, (matches,)."""
        fitting = np.flatnonzero(self.alike & (self.common_ns > 0))
        detections, truths, common_ns = self.detections[fitting], self.truths[fitting], self.common_ns[fitting]
        overlaps = common_ns / (self.durations_ns[fitting].sum(axis=1) - common_ns)
        best_first = np.lexsort((truths, -overlaps, detections))
        claims = best_first[np.unique(detections[best_first], return_index=True)[1]]
        best = np.zeros(truths.max(initial=-1) + 1)
        np.maximum.at(best, truths[claims], overlaps[claims])
        return best[best > 0]

    def count(self, among: Mask) -> int:
        """Count the detections in some of the pairs (n,)."""
        return len(np.unique(self.detections[among]))


@dataclass(frozen=True)
class Found:
    """Everything that is scored: what was found in some recordings, what was done there, and who was seen when."""

    detections: Sequence[Detection] = ()
    truths: Sequence[Truth] = ()
    seen: Sequence[Stretch] = ()

    @cached_property
    def pairs(self) -> Pairs:
        """All pairs of what was found and what its person did."""
        return Pairs.of(self.detections, self.truths)

    def __add__(self, other: "Found") -> "Found":
        return Found(
            (*self.detections, *other.detections), (*self.truths, *other.truths), (*self.seen, *other.seen)
        )  # fmt: skip

    @classmethod
    def of_all(cls, parts: Iterable["Found"]) -> "Found":
        """Put the parts together."""
        listed = list(parts)
        return cls(
            [each for part in listed for each in part.detections],
            [each for part in listed for each in part.truths],
            [each for part in listed for each in part.seen],
        )

    def as_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {
            "detections": [asdict(detection) for detection in self.detections],
            "truths": [asdict(truth) for truth in self.truths],
            "seen": [asdict(stretch) for stretch in self.seen],
        }


def point_fractions(truths: Iterable[Truth]) -> dict[str, float]:
    """Return where in an action its action point lies, by label: the median fraction (0 to 1) of its duration."""
    fractions: dict[str, list[float]] = {}
    for truth in truths:
        if truth.point_ns is not None and truth.end_ns > truth.start_ns:
            fraction = (truth.point_ns - truth.start_ns) / (truth.end_ns - truth.start_ns)
            fractions.setdefault(truth.label, []).append(fraction)
    return {label: median_high(of_label) for label, of_label in fractions.items()}


def _columns(
    intervals: Sequence[Detection | Truth],
) -> tuple[list[tuple[str, int]], NDArray[np.int64], NDArray[np.object_]]:
    """Return the file and agent, the bounds (n, 2; ns) and the label of each interval."""
    bounds_ns = np.array([(each.start_ns, each.end_ns) for each in intervals], np.int64).reshape(-1, 2)
    labels = np.array([each.label for each in intervals], object)
    return [(each.file, each.agent) for each in intervals], bounds_ns, labels
