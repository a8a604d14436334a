"""Bursts: stretches of movement that may be a repetition."""

import numpy as np

from actum.arrays import Array, Indices
from actum_examples.cutting.courses import RATE_HZ
from actum_examples.cutting.movement import Movement

LEVELS = (0.08, 0.12, 0.18, 0.25, 0.35, 0.5, 0.7)
"""Activities above which a burst begins: the lowest finds slow actions, the highest parts what follows closely."""
PAUSES_S = (0.0, 0.25, 0.5, 0.9)
"""Stops (s) that a burst may contain: actions of two strokes have some."""
SHORTEST_S = 0.35
"""Shortest burst (s): a wave of one stroke."""
LONGEST_S = 12.0
"""Longest burst (s): people take less for any action of the public sets."""
MOST = 1000
"""Most bursts that are compared with one another, about three minutes' worth; of more, those of fewer levels."""


def bursts_of(movement: Movement) -> Indices:
    """List the bursts at all levels, shape (bursts, 2): first instant and the one after the last, in order of end."""
    for levels in (LEVELS, LEVELS[1::2], LEVELS[3:4]):
        found = {
            burst
            for signal in (movement.activity, movement.pace)
            for level in levels
            for pause_s in PAUSES_S
            for burst in _above(signal, level, pause_s)
        }
        if len(found) <= MOST:
            break
    ordered = sorted(found, key=lambda burst: (burst[1], burst[0]))[:MOST]
    return np.array(ordered, dtype=np.int64).reshape(-1, 2)


def _above(signal: Array, level: float, pause_s: float) -> list[tuple[int, int]]:
    """List the stretches above a level, joined across stops up to a pause, that are of a possible length."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], signal > level, [0]])))
    starts, ends = edges[::2], edges[1::2]
    apart = starts[1:] - ends[:-1] > pause_s * RATE_HZ
    starts, ends = starts[np.r_[True, apart][: len(starts)]], ends[np.r_[apart, True][: len(ends)]]
    return [
        (int(start), int(end))
        for start, end in zip(starts, ends, strict=True)
        if SHORTEST_S * RATE_HZ <= end - start <= LONGEST_S * RATE_HZ
    ]
