"""What is simpler: scores of each object at every instant of a take, (T, n), from the hands' paths alone."""

from collections.abc import Callable, Sequence

import numpy as np
from benchmarks.intent.takes import Take

from actum.arrays import Array, Mask
from actum.node import SECOND_NS

Method = Callable[[Take], Array]
"""Scores each object at every instant of a take, (T, n): the higher, the likelier it is touched."""
STEP_S = 0.1
"""Over how long a hand's velocity is measured (s)."""
RESTING_MPS = 0.1
"""A hand slower than this (m/s) rests: a movement begins when it is no longer so slow."""
AHEAD_S = 1.0
"""How far ahead (s) a hand is thought to go on at its velocity."""
PATH_S = 0.4
"""Length of the paths that are compared with those of training (s)."""
POINTS = 5
"""Points of such a path."""
MOST_PATHS = 4000
"""Paths of training that are kept."""
HORIZON_S = 1.5
"""Paths of training that lead to a contact within so long (s)."""


def nearest(take: Take) -> Array:
    """The nearer an object is to a hand, the likelier."""
    return _best_hand(take, lambda hand_m, _: hand_m)


def constant_velocity(take: Take) -> Array:
    """The nearer the hand comes within `AHEAD_S`, going on at its velocity; a hand at rest goes nowhere."""
    scores = []
    for hand_m in _hands(take):
        velocity = (hand_m - hand_m[_rows_before(take, STEP_S)]) / STEP_S
        speed2 = (velocity**2).sum(axis=1)
        apart = _objects(take) - hand_m[:, None]
        after_s = np.clip((apart @ velocity[..., None])[..., 0] / np.maximum(speed2, 1e-9)[:, None], 0.0, AHEAD_S)
        missed_m = np.linalg.norm(apart - after_s[..., None] * velocity[:, None], axis=2)
        scores.append(np.where(speed2[:, None] > RESTING_MPS**2, -missed_m, -np.inf))
    return np.fmax(*scores)


def minimum_jerk(take: Take) -> Array:
    """The nearer an object is to where the hand will stop, if it moves at minimum jerk since it last rested.

    The product of elapsed time and speed over the way is s'(τ)τ/s(τ), which tells the share τ of the time that is over.
    """
    shares = np.linspace(0.05, 1.0, 96)
    way = shares**3 * (10 - 15 * shares + 6 * shares**2)
    ratio = shares * 30 * shares**2 * (1 - shares) ** 2 / way

    def end_of(hand_m: Array, take: Take) -> Array:
        before = _rows_before(take, STEP_S)
        middle_m, middle_ns = (hand_m + hand_m[before]) / 2, (take.stamps_ns + take.stamps_ns[before]) // 2
        speed = np.linalg.norm(hand_m - hand_m[before], axis=1) / STEP_S
        moving = speed > RESTING_MPS
        began = np.maximum.accumulate(np.where(moving, 0, np.arange(len(speed))))
        gone_m, elapsed_s = middle_m - middle_m[began], (middle_ns - middle_ns[began]) / SECOND_NS
        now = elapsed_s * speed / np.maximum(np.linalg.norm(gone_m, axis=1), 1e-3)
        over = np.interp(-now, -ratio, way)
        return np.where(moving[:, None], middle_m[began] + gone_m / over[:, None], np.nan)

    return _best_hand(take, end_of)


def of_nearest_path(training: Sequence[Take]) -> Method:
    """The nearer an object is to where the most similar path of training led, as far from the hand as there."""
    paths, ends = [], []
    for take in training:
        hands = _hands(take)
        for contact in take.contacts:
            left_s = (contact.stamp_ns - take.stamps_ns) / SECOND_NS
            rows = np.flatnonzero((left_s > 0) & (left_s <= HORIZON_S))[::3]
            path = _paths(hands[contact.hand], take)[rows]
            at = int(np.searchsorted(take.stamps_ns, contact.stamp_ns))
            paths.append(path)
            ends.append(hands[contact.hand][min(at, len(left_s) - 1)] - hands[contact.hand][rows])
    known, led = np.concatenate(paths), np.concatenate(ends)
    usable = np.flatnonzero(np.isfinite(known).all(axis=1) & np.isfinite(led).all(axis=1))
    usable = usable[:: max(1, len(usable) // MOST_PATHS)]
    known, led = known[usable], led[usable]

    def end_of(hand_m: Array, take: Take) -> Array:
        own = _paths(hand_m, take)
        ends_m = np.full_like(hand_m, np.nan)
        for row in np.flatnonzero(np.isfinite(own).all(axis=1) & (np.abs(own).max(axis=1) > RESTING_MPS * PATH_S)):
            ends_m[row] = hand_m[row] + led[((known - own[row]) ** 2).sum(axis=1).argmin()]
        return ends_m

    return lambda take: _best_hand(take, end_of)


def never(take: Take) -> Array:
    """Say nothing."""
    return np.full((len(take.stamps_ns), len(take.objects_m)), -np.inf)


def _best_hand(take: Take, end_of: Callable[[Array, Take], Array]) -> Array:
    """Return minus the distance of each object from where either hand will be; minus infinity where that is unknown."""
    objects_m = _objects(take)
    scores = [-np.linalg.norm(objects_m - end_of(hand_m, take)[:, None], axis=2) for hand_m in _hands(take)]
    return np.nan_to_num(np.fmax(*scores), nan=-np.inf)


def _hands(take: Take) -> Array:
    return take.arms_m[:, :2].swapaxes(0, 1)


def _objects(take: Take) -> Array:
    """Return where each object is, or was seen last, (T, n, 3); before it was seen, where it was seen first."""
    filled = []
    for _, path_m in sorted(take.objects_m.items()):
        seen: Mask = np.isfinite(path_m.sum(axis=1))
        last = np.maximum.accumulate(np.where(seen, np.arange(len(seen)), 0))
        last[: seen.argmax()] = seen.argmax()
        filled.append(path_m[last])
    return np.stack(filled, axis=1)


def _paths(hand_m: Array, take: Take) -> Array:
    """Return the way of a hand over the last `PATH_S`, (T, 3 * POINTS), from its present place."""
    instants_s = np.linspace(0, PATH_S, POINTS + 1)[1:]
    return np.concatenate([hand_m[_rows_before(take, float(s))] - hand_m for s in instants_s], axis=1)


def _rows_before(take: Take, seconds: float) -> np.ndarray:
    """Return the row so long before each row (s), the first where there is none."""
    rows = np.searchsorted(take.stamps_ns, take.stamps_ns - round(seconds * SECOND_NS), side="right") - 1
    return rows.clip(0)
