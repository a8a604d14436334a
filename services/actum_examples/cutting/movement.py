"""When a person moves, by what they may be taken to rest in."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array
from actum_examples.cutting.courses import RATE_HZ, Course, smoothed

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
ABOVE_NOISE = 2.0
"""A joint is away from its rest where it is farther than its standing noise by this factor."""
LEAST_AWAY_M = 0.02
"""Distance from rest (root mean square over the joints, m) of the least movement: one hand by 0.08 m."""
LEAST_PACE_MPS = 0.05
"""Speed (root mean square over the joints, m/s) of the least movement: one hand at 0.2 m/s."""


@dataclass(frozen=True, eq=False)
class Movement:
    """How much a person moves, taking one posture for that of rest.

    Attributes:
        activity: (n,), 0 where at rest, about 1 in the midst of a movement: speed and distance from rest together.
        pace: (n,), the speed alone in the same unit.
        moved_s: (n + 1,), running sum of the time in which the person moves.
        moving: (n,), how much of each instant is movement, 0 to 1.
    """

    activity: Array
    pace: Array
    moved_s: Array
    moving: Array


def movement_about(course: Course, rest: Array) -> Movement:
    """Return the movement in a course about a posture of rest (15, 3)."""
    squares = ((course.postures - rest) ** 2).sum(axis=2) - (ABOVE_NOISE * course.noise_m) ** 2
    away_m = np.sqrt(np.maximum(squares, 0).mean(axis=1))
    away = _in_units(np.maximum(away_m - np.quantile(away_m, STILL_SHARE), 0), LEAST_AWAY_M)
    pace = _in_units(course.speeds_mps, LEAST_PACE_MPS)
    activity = smoothed(np.hypot(pace, away))
    moving = activity**2 / (activity**2 + HALF_MOVING**2)
    return Movement(activity, smoothed(pace), np.concatenate([[0.0], np.cumsum(moving)]) / RATE_HZ, moving)


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


def _in_units(values: Array, least: float) -> Array:
    """Divide values (n,) by their mean weighted by themselves: by that of movements, however long the rests between.

    What is below the least that a movement has stays small.
    """
    total = float(values.sum())
    scaled: Array = values / max(float((values**2).sum()) / total if total > 0 else 0.0, least)
    return scaled
