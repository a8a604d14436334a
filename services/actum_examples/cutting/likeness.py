"""How alike two bursts of movement are."""

import numpy as np

from actum.arrays import Array, Indices
from actum_examples.cutting.courses import Course
from actum_examples.cutting.movement import Movement

SAMPLES = 12
"""Postures by which a burst is compared: each stroke of a wave still has two."""
EVEN = 0.5
"""Share of the mean speed that passes as movement at every instant, so that a hold takes little of the samples."""
SPREAD = 0.6
"""Distance of two bursts, in units of the course's spread, at which their likeness is halved."""
LOG_DURATION = 0.5
"""Logarithm of the ratio of durations at which the likeness is halved: one takes 1.6 times as long as the other."""


def likeness_of(course: Course, movement: Movement, bursts: Indices) -> Array:
    """Return how alike the bursts (b, 2) of a course are, shape (b, b), 0 to 1.

    Bursts are compared by the way that the postures go, not by when: people hold a posture now longer, now shorter.
    Each joint counts by the share of its variance that is movement rather than noise. A burst's likeness to itself is
    that to the one most like it that does not overlap it.
    """
    weights = movement.moving + 1e-9  # rests of any length change nothing
    middle = np.average(course.postures, axis=0, weights=weights)
    variances: Array = np.average(((course.postures - middle) ** 2).sum(axis=2), axis=0, weights=weights)
    moved = np.maximum(variances - course.noise_m**2, 0)
    trust = moved / (moved + course.noise_m**2 + 1e-12)
    ways = _ways(course, course.postures * np.sqrt(trust)[:, None], bursts)
    squares = (ways**2).sum(axis=1)
    noise, spread = (float((trust * each).mean()) for each in (course.noise_m**2, moved))
    distances = np.maximum(squares[:, None] + squares - 2 * ways @ ways.T - 2 * noise, 0)
    ratios = np.subtract.outer(*2 * [np.log(bursts[:, 1] - bursts[:, 0])])
    likeness: Array = 1 / (1 + distances / max(SPREAD**2 * spread, 1e-12) + (ratios / LOG_DURATION) ** 2)
    follows = np.greater_equal.outer(bursts[:, 0], bursts[:, 1])
    np.fill_diagonal(likeness, np.where(follows | follows.T, likeness, 0).max(axis=1))
    return likeness


def _ways(course: Course, postures: Array, bursts: Indices) -> Array:
    """Return the way of each burst through postures at even shares of its movement, shape (b, samples * 45)."""
    moved = np.cumsum(course.speeds_mps + EVEN * course.speeds_mps.mean() + 1e-9)
    first, last = moved[bursts[:, 0]], moved[bursts[:, 1] - 1]
    wanted = first[:, None] + np.linspace(0, 1, SAMPLES) * (last - first)[:, None]
    places = np.interp(wanted.ravel(), moved, np.arange(len(moved)))
    before = np.clip(places.astype(int), 0, len(moved) - 2)
    share = (places - before)[:, None]
    flat = postures.reshape(len(postures), -1)
    way = (1 - share) * flat[before] + share * flat[before + 1]
    ways: Array = way.reshape(len(bursts), -1) / np.sqrt(SAMPLES * postures.shape[1])
    return ways
