"""The object that a hand reached for without moving any: by distance, and by the direction of the reach."""

from collections.abc import Mapping, Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.hand_tracks import HandTrack, last_instants_away
from action_fusion.settings import Settings
from action_fusion.stops import stops
from action_fusion.turns import noise_m
from actum.arrays import Array, Indices, Mask

REACH_STEP_M = 0.05
"""Length of a reach's last step, which gives its direction: several times a joint's noise."""

NUDGE_M = 0.001
"""Least motion of a nudged object: less is the table's trembling."""

NUDGE_TO_NOISE = 5.0
"""Least ratio of a nudge to the noise's standard deviation."""

TOUCHED_M = 0.13
"""Largest distance of a hand that touches an object, required of a hand that has acted elsewhere before: from the palm
to the fingertips, and half of a small object."""

RIM_M = 0.10
"""Largest miss of a reach that stops at an object's rim, further from its centre than a grasp: half of an object of two
decimetres."""

AIMED = 0.5
"""Least share of the last step by which the hand came nearer to an object that the reach aims at: within 60 degrees."""


def misses_m(hand: HandTrack, pairs: Sequence[Comotion], settings: Settings) -> Mapping[int, float]:
    """Measure the distance by which the hand misses each object that it may have reached, by the object's id.

    A reach ends on a straight line to its goal. Let c = (r' - r) / s be the share of the hand's last step s by which
    its distance from the object fell from r' to r. The line of the step passes the object at r sqrt(1 - c^2); a hand
    that made no step, or moved away, misses the object by r. The miss is the median over the instants of the hand's
    last stop at which the object is within grasp, or the hand has stopped at its rim after a reach aimed at it.

    Only instants that follow a reach aimed at some object count. Without such a reach all instants count, if they make
    up half of the segment. A hand that stopped elsewhere before must touch an object to have reached for it.
    """
    if not pairs:
        return {}
    since = last_instants_away(hand.positions_m, REACH_STEP_M)
    closings = np.stack([_closing(hand, pair, since) for pair in pairs])
    distances = np.stack([pair.distances_m for pair in pairs])
    stopped = stops(hand)
    missed = distances * np.sqrt(1 - closings**2)
    in_grasp = distances <= (TOUCHED_M if stopped.acted_before else settings.grasp_m)
    at_rim = (distances <= settings.reach_m) & (missed <= RIM_M) & (not stopped.acted_before)
    aimed = (in_grasp | at_rim) & (closings >= AIMED)
    arrived: Mask = stopped.last & np.asarray(aimed.any(axis=0))
    counted = (in_grasp | aimed) & arrived if arrived.any() else in_grasp & stopped.last
    fewest = 1 if arrived.any() else max(1, np.count_nonzero(hand.in_segment) / 2)
    touched: Mask = counted.sum(axis=1) >= fewest
    return {
        pair.track.id: float(np.median(missed[row, counted[row]])) for row, pair in enumerate(pairs) if touched[row]
    }


def nudge_m(pair: Comotion) -> float:
    """Measure an object's motion within the segment (m, root mean square); 0 where it may be noise."""
    positions_m = pair.object_m[pair.hand.in_segment]
    least_m = max(NUDGE_M, NUDGE_TO_NOISE * noise_m(positions_m))
    nudged_m = float(np.linalg.norm(positions_m.std(axis=0))) if np.isfinite(least_m) else 0.0
    return nudged_m if nudged_m >= least_m else 0.0


def _closing(hand: HandTrack, pair: Comotion, since: Indices) -> Array:
    """Measure the share (n,) of the hand's last step by which the hand came nearer to the object, 0 to 1."""
    steps = np.linalg.norm(hand.positions_m - hand.positions_m[since], axis=1)
    nearer = np.linalg.norm(pair.object_m - hand.positions_m[since], axis=1) - pair.distances_m
    shares = np.divide(nearer, steps, out=np.zeros_like(steps), where=(since >= 0) & (steps > 0))
    closing: Array = np.clip(shares, 0.0, 1.0)
    return closing
