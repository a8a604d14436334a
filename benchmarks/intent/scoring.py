"""How early and how rightly contacts are foreseen; what is said counts from the frame in which it was computed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from benchmarks.intent.takes import Contact, Take

from actum.arrays import Array
from actum.node import SECOND_NS

HORIZON_S = 1.5
"""A contact counts as foreseen within so long (s)."""
PRECISION = 0.9
"""Share of announcements that must be right."""
BREAK_S = 0.3
"""An announcement goes on over gaps up to this (s): it flickers."""
LATE_S = 0.5
"""An announcement that begins so soon (s) after its contact still tells of it, though not ahead."""
THRESHOLDS = 60
"""Thresholds tried."""
ALARM = 0.7
"""Probability from which a contact is announced for the count of false alarms."""
BACKGROUND = 0.05
"""Probabilities below are not counted in the calibration: nearly all instants have no more, and are right."""
BINS = 10
"""Of the calibration."""
BEFORE_S = (1.0, 0.5, 0.25)
"""When before a contact (s) the likeliest object is looked at."""


@dataclass(frozen=True)
class Said:
    """What was said in a take: at T stamps a score of each object (T, n), the time to its contact (T, n; s) if told."""

    take: Take
    scores: Array
    contact_s: Array | None = None

    @property
    def stamps_s(self) -> Array:
        seconds: Array = self.take.stamps_ns / SECOND_NS
        return seconds

    @property
    def numbers(self) -> list[int]:
        return sorted(self.take.objects_m)

    def announcements(self, threshold: float) -> Iterator["Announcement"]:
        """Yield from when to when an object is announced."""
        likeliest = self.scores.argmax(axis=1)
        current: Announcement | None = None
        for row in np.flatnonzero(self.scores.max(axis=1) >= threshold).tolist():
            at_s, number = float(self.stamps_s[row]), self.numbers[likeliest[row]]
            if current and current.number == number and at_s - current.last_s <= BREAK_S:
                current = current._replace(last_s=at_s)
                continue
            if current:
                yield current
            current = Announcement(number, at_s, at_s)
        if current:
            yield current


class Announcement(NamedTuple):
    """An object whose contact is announced from one instant to another (s)."""

    number: int
    first_s: float
    last_s: float

    def tells_of(self, contact: Contact) -> bool:
        """Tell whether the contact that is announced is this one."""
        at_s = contact.stamp_ns / SECOND_NS
        return contact.number == self.number and self.first_s - LATE_S <= at_s <= self.last_s + HORIZON_S

    def ahead_s(self, contact: Contact) -> float:
        """Return how long before a contact it is announced (s); 0 where it is not, or not before."""
        return min(max(contact.stamp_ns / SECOND_NS - self.first_s, 0.0), HORIZON_S) if self.tells_of(contact) else 0.0


class Ahead(NamedTuple):
    """How early at a threshold: median time ahead (s) of all contacts, those not announced counting 0; the shares of
    announcements that are right, and of contacts that are announced ahead."""

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
    """So long before the contacts: the share of which the likeliest object is the right one, the Brier score over the
    objects and none, and the median error of the time to contact (s); NaN where no time is told."""

    right: float
    brier: float
    time_error_s: float


def before(said: Sequence[Said], seconds: float) -> Before:
    """Look at what was said so long before each contact (s)."""
    right, brier, errors_s = [], [], []
    for each in said:
        for contact in each.take.contacts:
            at_s = contact.stamp_ns / SECOND_NS - seconds
            row = int(np.searchsorted(each.stamps_s, at_s, side="right")) - 1
            if row < 0:
                continue
            truth = np.array(each.numbers) == contact.number
            scores = each.scores[row]
            right.append(bool(truth[scores.argmax()]) and np.isfinite(scores.max()))
            brier.append(float(((scores - truth) ** 2).sum() + max(1 - scores.sum(), 0.0) ** 2))
            if each.contact_s is not None:
                left_s = contact.stamp_ns / SECOND_NS - each.stamps_s[row]
                errors_s.append(abs(float(each.contact_s[row][truth][0]) - left_s))
    return Before(float(np.mean(right)), float(np.mean(brier)), float(np.median(errors_s)) if errors_s else np.nan)


def calibration_error(said: Sequence[Said]) -> float:
    """Return the expected calibration error of the likeliest object's probability that it is touched next in time."""
    told, true = [], []
    for each in said:
        told.append(each.scores.max(axis=1))
        true.append(touched_next(each)[np.arange(len(each.scores)), each.scores.argmax(axis=1)])
    probability, came = np.concatenate(told), np.concatenate(true)
    counted = probability > BACKGROUND
    probability, came = probability[counted], came[counted]
    in_bin = [np.minimum((probability * BINS).astype(int), BINS - 1) == k for k in range(BINS)]
    gaps = [abs(probability[k].mean() - came[k].mean()) * k.mean() for k in in_bin if k.any()]
    return float(sum(gaps))


def touched_next(said: Said) -> Array:
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
