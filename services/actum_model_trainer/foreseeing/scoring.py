"""How early and how rightly contacts are foreseen; what is said counts from the frame in which it was computed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.calibration_error import calibration_error as error_of_bins
from actum_model_trainer.calibration_error import confidence_bins
from actum_model_trainer.foreseeing.takes import Contact, Take

HORIZON_S = 1.5
"""A contact counts as foreseen within so long (s)."""
PRECISION = 0.9
"""Share of announcements that must be right."""
BREAK_S = 0.3
"""An announcement goes on over gaps up to this (s): it flickers."""
LATE_S = 0.2
"""An announcement that begins so soon (s) after its contact still tells of it, though not ahead: where objects are is
known 0.1 s late."""
THRESHOLDS = 60
"""Thresholds tried."""
ALARM = 0.7
"""Probability from which a contact is announced for the count of false alarms."""
BACKGROUND = 0.05
"""Probabilities below are not counted in the calibration: nearly all instants have no more, and are right."""
BEFORE_S = (1.0, 0.5, 0.25)
"""When before a contact (s) the likeliest object is looked at."""


@dataclass(frozen=True)
class Said:
    """What was said in a take.

    Attributes:
        scores: (T, n), of each object at each of the T stamps: the higher, the likelier it is touched. Probabilities of
            objects that different hands are about to touch sum to more than 1.
        contact_s: (T, n), the time until its contact (s); None where no times are said.
    """

    take: Take
    scores: Array
    contact_s: Array | None = None

    @property
    def stamps_s(self) -> Array:
        """The take's stamps (s)."""
        seconds: Array = self.take.stamps_ns / SECOND_NS
        return seconds

    @property
    def numbers(self) -> list[int]:
        """The objects' numbers, in the order of the scores."""
        return sorted(self.take.objects_m)

    def announcements(self, threshold: float) -> Iterator["Announcement"]:
        """Yield when each object is announced; one that goes on for longer than the horizon is announced anew.

        While somebody points at something, an announcement is neither right nor wrong, and is left out.
        """
        counted = ~self.take.in_pointing(self.take.stamps_ns)
        for number, scores in zip(self.numbers, self.scores.T, strict=True):
            first_s = last_s = -np.inf
            for at_s in self.stamps_s[counted & (scores >= threshold)].tolist():
                if at_s > min(last_s + BREAK_S, first_s + HORIZON_S):
                    first_s = at_s
                    yield Announcement(number, first_s)
                last_s = at_s


class Announcement(NamedTuple):
    """An object whose contact is announced from an instant on (s)."""

    number: int
    first_s: float

    def tells_of(self, contact: Contact) -> bool:
        """Tell whether the contact that is announced is this one."""
        at_s = contact.stamp_ns / SECOND_NS
        return contact.number == self.number and self.first_s - LATE_S <= at_s <= self.first_s + HORIZON_S

    def ahead_s(self, contact: Contact) -> float:
        """Return how long before a contact it is announced (s); 0 where it is not, or not before."""
        return min(max(contact.stamp_ns / SECOND_NS - self.first_s, 0.0), HORIZON_S) if self.tells_of(contact) else 0.0


class Ahead(NamedTuple):
    """How early contacts are announced at a threshold.

    Attributes:
        median_s: median time ahead (s) of all contacts; one that is not announced counts as 0.
        precision: share of announcements that are right.
        recall: share of contacts that are announced ahead.
    """

    threshold: float
    median_s: float
    precision: float
    recall: float


def ahead(said: Sequence[Said], threshold: float) -> Ahead:
    """Return how early contacts are announced at a threshold."""
    right, times_s = [], []
    for each in said:
        announced = list(each.announcements(threshold))
        right += [any(one.tells_of(contact) for contact in each.take.contacts) for one in announced]
        times_s += [max((one.ahead_s(c) for one in announced), default=0.0) for c in each.take.contacts]
    if not right:
        return Ahead(threshold, 0.0, 0.0, 0.0)
    return Ahead(threshold, float(np.median(times_s)), float(np.mean(right)), float(np.mean(np.array(times_s) > 0)))


def earliest(said: Sequence[Said]) -> Ahead:
    """Return how early contacts are announced at the threshold that is earliest with the precision asked for."""
    scores = np.concatenate([each.scores.max(axis=1) for each in said])
    finite = scores[np.isfinite(scores)]
    if not len(finite):
        return Ahead(np.inf, 0.0, 0.0, 0.0)
    tried = np.unique(np.quantile(finite, 1 - np.geomspace(0.5, 1e-4, THRESHOLDS)))
    found = [each for each in (ahead(said, float(threshold)) for threshold in tried) if each.precision >= PRECISION]
    return max(found, key=lambda each: (each.median_s, each.recall), default=Ahead(np.inf, 0.0, 0.0, 0.0))


class Before(NamedTuple):
    """What was said so long before the contacts; NaN where nothing was.

    Attributes:
        right: share of contacts whose likeliest object is the right one.
        brier: mean Brier score over the objects, each touched within the horizon or not, and none of them.
        time_error_s: median error of the time to contact (s); NaN where no times are said.
    """

    right: float
    brier: float
    time_error_s: float


def before(said: Sequence[Said], seconds: float) -> Before:
    """Look at what was said so long before each contact (s)."""
    right, brier, errors_s = [], [], []
    for each in said:
        coming = touched_soon(each)
        for contact in each.take.contacts:
            at_s = contact.stamp_ns / SECOND_NS - seconds
            row = int(np.searchsorted(each.stamps_s, at_s, side="right")) - 1
            if row < 0:
                continue
            truth = np.array(each.numbers) == contact.number
            scores, soon = each.scores[row], coming[row]
            right.append(bool(truth[scores.argmax()]) and np.isfinite(scores.max()))
            brier.append(float(((scores - soon) ** 2).sum() + max(1 - scores.sum(), 0.0) ** 2))
            if each.contact_s is not None:
                left_s = contact.stamp_ns / SECOND_NS - each.stamps_s[row]
                errors_s.append(abs(float(each.contact_s[row][truth][0]) - left_s))
    if not right:
        return Before(np.nan, np.nan, np.nan)
    return Before(float(np.mean(right)), float(np.mean(brier)), float(np.median(errors_s)) if errors_s else np.nan)


class Scores(NamedTuple):
    """How early contacts are announced at `PRECISION`, and what is said at each of `BEFORE_S`."""

    ahead: Ahead
    before: tuple[Before, ...]

    @classmethod
    def of(cls, said: Sequence[Said]) -> Self:
        """Score what was said in takes."""
        return cls(earliest(said), tuple(before(said, seconds) for seconds in BEFORE_S))

    @property
    def at_half(self) -> Before:
        """What is said half a second before."""
        return self.before[BEFORE_S.index(0.5)]

    @property
    def is_probable(self) -> bool:
        """Whether the scores are probabilities, to which times are said: only then is a Brier score of use."""
        return not np.isnan(self.at_half.time_error_s)


def calibration_error(said: Sequence[Said]) -> float:
    """Return the expected calibration error of the likeliest object's probability of a touch within the horizon."""
    return expected_calibration_error(np.concatenate([outcomes(each) for each in said]))


def outcomes(said: Said) -> Array:
    """Return the likeliest object's probability of a touch within the horizon, and whether it came, (instants, 2)."""
    likeliest = np.arange(len(said.scores)), said.scores.argmax(axis=1)
    probability, came = said.scores[likeliest], touched_soon(said)[likeliest]
    counted = (probability > BACKGROUND) & ~said.take.in_pointing(said.take.stamps_ns)
    both: Array = np.stack([probability, came], axis=1)[counted]
    return both


def expected_calibration_error(of: Array) -> float:
    """Return the expected calibration error of probabilities and whether what they are of came, (N, 2)."""
    return error_of_bins(confidence_bins(*of.T)) if len(of) else 0.0


def touched_soon(said: Said) -> Array:
    """Tell for each instant and object whether it is touched within the horizon, (T, n)."""
    coming = np.zeros(said.scores.shape, bool)
    for contact in said.take.contacts:
        left_s = contact.stamp_ns / SECOND_NS - said.stamps_s
        coming[(left_s > 0) & (left_s <= HORIZON_S), said.numbers.index(contact.number)] = True
    return coming


def false_alarms_per_min(said: Sequence[Said]) -> float:
    """Return how often a minute a contact is announced that does not come."""
    alarms = sum(
        not any(one.tells_of(contact) for contact in each.take.contacts)
        for each in said
        for one in each.announcements(ALARM)
    )
    return alarms / sum(each.take.minutes for each in said)
