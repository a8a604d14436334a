"""When a person moves, by what they may be taken to rest in."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from actum_model_trainer.cutting.courses import RATE_HZ, Course

RESTS = 3
"""Postures that are tried as the one of rest: a hold in the middle of each repetition may last longer than the rest."""
SLOW_SHARE = 0.5
"""Share of the instants, the slowest, among which rest is sought."""
LEAST_REST_SHARE = 0.08
"""A posture of rest takes at least this share of the slow instants."""
COMPARED = 300
"""Slow instants that are compared with one another: enough for the densest place, and quick."""
NEAR_SHARE = 0.2
"""Share of the pairs of slow instants that count as near to one another."""
LEAST_NEAR_M = 0.02
"""Postures that differ by less (m, root mean square over the joints) are the same."""
STILL_SHARE = 0.1
"""Quantile of the distance from rest that counts as none."""
HALF_MOVING = 0.25
"""Activity at which an instant counts half as movement."""
SMOOTHING = np.array([1.0, 3.0, 4.0, 3.0, 1.0]) / 12
"""Weights of neighbouring instants, a third of a second in all: one jump of a joint is no movement."""


@dataclass(frozen=True, eq=False)
class Movement:
    """How much a person moves, taking one posture for that of rest.

    Attributes:
        activity: (n,), 0 where at rest, about 1 in the midst of a movement: speed and distance from rest together.
        pace: (n,), the speed alone in the same unit.
        moved_s: (n + 1,), running sum of the time in which the person moves.
    """

    activity: Array
    pace: Array
    moved_s: Array


def movement_about(course: Course, rest: Array) -> Movement:
    """Return the movement in a course about a posture of rest (15, 3)."""
    away_m = np.sqrt(((course.postures - rest) ** 2).sum(axis=2).mean(axis=1))
    away = _in_units(np.maximum(away_m - np.quantile(away_m, STILL_SHARE), 0))
    pace = _in_units(course.speeds_mps)
    activity = _smoothed(np.hypot(pace, away))
    moving = activity**2 / (activity**2 + HALF_MOVING**2)
    return Movement(activity, _smoothed(pace), np.concatenate([[0.0], np.cumsum(moving)]) / RATE_HZ)


def rest_postures(course: Course) -> list[Array]:
    """Return up to `RESTS` postures (15, 3) in which the person is slow for long, the most frequent first."""
    slow = np.flatnonzero(course.speeds_mps <= np.quantile(course.speeds_mps, SLOW_SHARE))
    slow = slow[:: max(1, len(slow) // COMPARED)]
    flat = course.postures[slow].reshape(len(slow), -1)
    apart_m = np.sqrt(((flat[:, None] - flat[None]) ** 2).sum(axis=2) / course.postures.shape[1])
    near_m = max(float(np.quantile(apart_m, NEAR_SHARE)), LEAST_NEAR_M)
    nearness, left = np.exp(-((apart_m / near_m) ** 2)), np.ones(len(slow), dtype=bool)
    rests: list[Array] = []
    while len(rests) < RESTS and left.sum() >= max(LEAST_REST_SHARE * len(slow), 1):
        densest = int(np.argmax((nearness * left).sum(axis=1) * left))
        rests.append(np.median(course.postures[slow[left & (apart_m[densest] <= near_m)]], axis=0))
        left &= apart_m[densest] > 2 * near_m
    return rests


def _in_units(values: Array) -> Array:
    """Divide values (n,) by their mean weighted by themselves: by that of movements, however long the rests between."""
    total = float(values.sum())
    scaled: Array = values * total / float((values**2).sum()) if total > 0 else np.zeros_like(values)
    return scaled


def _smoothed(values: Array) -> Array:
    """Average values (n,) with their neighbours."""
    reach = len(SMOOTHING) // 2
    averaged: Array = np.convolve(np.pad(values, reach, mode="edge"), SMOOTHING, mode="valid").astype(np.float64)
    return averaged
