"""The object that a hand reached for without moving any: by distance, and by the direction of the reach."""

from collections.abc import Sequence

import numpy as np

from action_fusion.choice.evidence import Choice, Evidence
from action_fusion.settings import Settings
from action_fusion.tracks.comotion import Comotion, distances_m
from action_fusion.tracks.hand_tracks import HandTrack, stops
from action_fusion.tracks.object_tracks import noise_m
from actum.arrays import Array, Indices, Mask, median
from actum.core import steps

REACH_STEP_M = 0.05
"""Length of a reach's last step, which gives its direction: several times a joint's noise."""

NUDGE_M = 0.001
"""Least motion of a nudged object: less is the table's trembling."""

NUDGE_TO_NOISE = 5.0
"""Least ratio of a nudge to the noise's standard deviation."""

NUDGED_MORE = 3.0
"""An object counts as nudged if it moved this many times as far as every other one."""

TOUCHED_M = 0.13
"""Largest distance of a hand that touches an object, required of a hand that has acted elsewhere before: from the palm
to the fingertips, and half of a small object."""

RIM_M = 0.10
"""Largest miss of a reach that stops at an object's rim, further from its centre than a grasp: half of an object of two
decimetres."""

AIMED = 0.5
"""Least share of the last step by which the hand came nearer to an object that the reach aims at: within 60 degrees."""


def reached(evidence: Evidence) -> Choice | None:
    """Choose the object with the smallest miss of a hand; among nearly equal misses, an object that was nudged."""
    misses: list[tuple[float, Comotion]] = []
    for side in evidence.sides:
        misses += _misses([pair for pair in evidence.free if pair.hand.side == side], evidence.settings)
    if not misses:
        return None
    least_m = min(missed_m for missed_m, _ in misses)
    near = [miss for miss in misses if miss[0] <= least_m + evidence.settings.uncertainty_m]
    close = [pair for _, pair in sorted(near, key=lambda miss: miss[0])]
    nudged = _nudged(close)
    best = nudged or close[0]
    rivals = {pair.track.id: pair.track for pair in close if nudged is None and pair.track is not best.track}
    return Choice(best.track, (best.hand.side,), None, tuple(rivals.values()))


def _misses(pairs: Sequence[Comotion], settings: Settings) -> list[tuple[float, Comotion]]:
    """Measure by how much a hand misses each object that it may have reached, from the pairs of that hand.

    A reach ends on a straight line to its goal. Let c = (r' - r) / s be the share of the hand's last step s by which
    its distance from the object fell from r' to r. The line of the step passes the object at r sqrt(1 - c^2); a hand
    that made no step, or moved away, misses the object by r. The miss is the median over the instants of the hand's
    last stop at which the object is within grasp, or the hand has stopped at its rim after a reach aimed at it.

    Only instants that follow a reach aimed at some object count. Without such a reach all instants count, if they make
    up half of the segment. A hand that stopped elsewhere before must touch an object to have reached for it.
    """
    if not pairs:
        return []
    hand, stopped = pairs[0].hand, stops(pairs[0].hand)
    closings = _closings(hand, pairs, stopped.last)
    distances = np.stack([pair.distances_m for pair in pairs])
    missed = distances * np.sqrt(1 - closings**2)
    in_grasp = distances <= (TOUCHED_M if stopped.acted_before else settings.grasp_m)
    at_rim = (distances <= settings.reach_m) & (missed <= RIM_M) & (not stopped.acted_before)
    aimed = (in_grasp | at_rim) & (closings >= AIMED)
    arrived: Mask = stopped.last & np.asarray(aimed.any(axis=0))
    counted = (in_grasp | aimed) & arrived if arrived.any() else in_grasp & stopped.last
    fewest = 1 if arrived.any() else max(1, np.count_nonzero(hand.in_segment) / 2)
    touched: Mask = counted.sum(axis=1) >= fewest
    return [(float(median(missed[row, counted[row]])), pair) for row, pair in enumerate(pairs) if touched[row]]


def _closings(hand: HandTrack, pairs: Sequence[Comotion], instants: Mask) -> Array:
    """Measure the share (pairs, n) of the hand's last step by which it came nearer to each object, 0 to 1.

    The share is measured at the given instants (n,), and 0 at all others.
    """
    if steps is not None:
        compiled = np.empty((len(pairs), len(instants)))
        for pair, out in zip(pairs, compiled, strict=True):
            steps.closings(hand.positions_m, instants, REACH_STEP_M, pair.object_m, pair.distances_m, out)
        return compiled
    since = _last_instants_away(hand.positions_m, REACH_STEP_M, instants)
    steps_m = np.linalg.norm(hand.positions_m - hand.positions_m[since], axis=1)
    stepped = (since >= 0) & (steps_m > 0)
    before_m = np.stack([np.linalg.norm(pair.object_m - hand.positions_m[since], axis=1) for pair in pairs])
    nearer = before_m - np.stack([pair.distances_m for pair in pairs])
    closings: Array = np.clip(np.divide(nearer, steps_m, out=np.zeros_like(nearer), where=stepped), 0.0, 1.0)
    return closings


def _last_instants_away(positions_m: Array, step_m: float, instants: Mask) -> Indices:
    """Find, for the given ones (n,) of n positions (n, 3), the last earlier one that is `step_m` or more away.

    Returns:
        indices (n,), -1 where there is none.
    """
    last = np.full(len(positions_m), -1, dtype=np.int64)
    asked = np.flatnonzero(instants)
    away = distances_m(positions_m, positions_m[asked, None]) >= step_m
    away &= np.arange(len(positions_m)) < asked[:, None]
    latest = len(positions_m) - 1 - np.argmax(away[:, ::-1], axis=1)
    last[asked] = np.where(away.any(axis=1), latest, -1)
    return last


def _nudged(pairs: Sequence[Comotion]) -> Comotion | None:
    """Find the object that was nudged clearly further than every other one; None where there is none."""
    nudges = sorted(((_nudge_m(pair), i) for i, pair in enumerate(pairs)), reverse=True)
    most_m, best = nudges[0][0], pairs[nudges[0][1]]
    others = [nudged_m for nudged_m, i in nudges[1:] if pairs[i].track is not best.track]
    return None if most_m == 0 or any(other_m * NUDGED_MORE > most_m for other_m in others) else best


def _nudge_m(pair: Comotion) -> float:
    """Measure an object's motion within the segment (m, root mean square); 0 where it may be noise."""
    positions_m = pair.object_m[pair.hand.in_segment]
    least_m = max(NUDGE_M, NUDGE_TO_NOISE * noise_m(positions_m))
    nudged_m = float(np.linalg.norm(positions_m.std(axis=0))) if np.isfinite(least_m) else 0.0
    return nudged_m if nudged_m >= least_m else 0.0
