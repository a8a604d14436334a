"""Which object a hand has reached for, where it has moved none: by closeness, and by where the reach was heading."""

from collections.abc import Mapping, Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.hand_tracks import HandTrack, last_instants_away
from action_fusion.settings import Settings
from action_fusion.stops import stops
from actum.arrays import Array, Indices, Mask

REACH_STEP_M = 0.05
"""The last of a reach, by which its goal is told: several times a joint's noise, less than a hand's breadth."""

NUDGE_M = 0.001
"""An object that is touched gives way by more; less is the table's trembling."""

NUDGE_TO_NOISE = 5.0
"""A nudge is told from noise where it is at least this many standard deviations."""

FEWEST_POSITIONS = 10
"""From fewer positions the noise cannot be estimated."""

MAD_TO_STD = 0.6745
"""Median absolute deviation of a Gaussian, in standard deviations."""

TOUCHED_M = 0.13
"""A hand that has acted elsewhere is at an object only if it touches it: from the palm to the fingertips, and half of
a small object."""

RIM_M = 0.10
"""A hand that stops further from an object's centre than a grasp is at its rim if it went for it: its line passes
within half of an object of two decimetres."""

AIMED = 0.5
"""A reach heads at an object where at least half of its last step brought the hand nearer to it: within 60 degrees."""


def misses_m(hand: HandTrack, pairs: Sequence[Comotion], settings: Settings) -> Mapping[int, float]:
    """Measure by how much the hand misses each object that it may have reached, by the object's id.

    A reach ends on a line to its goal. With c = (r' - r) / s the share of the hand's last step s by which the
    distance r fell, the line of the step passes the object at r sqrt(1 - c^2); a hand that made no such step, or
    moved away, misses it by r. The median is taken over the instants at which the hand rests where it works last, with
    the object in grasp, or at its rim if it went for it. Of these only those count to which a reach for any object has
    led or, where no reach was seen, all, if they are most of the segment. A hand that has stopped elsewhere before has
    acted there, and on nothing, for nothing was moved: it has to touch what it is to have reached for.
    """
    if not pairs:
        return {}
    since = last_instants_away(hand.positions_m, REACH_STEP_M)
    closings = np.stack([_closing(hand, pair, since) for pair in pairs])
    distances = np.stack([pair.distances_m for pair in pairs])
    stopped = stops(hand)
    missed = distances * np.sqrt(1 - closings**2)
    at_hand = distances <= (TOUCHED_M if stopped.acted_before else settings.grasp_m)
    at_rim = (distances <= settings.reach_m) & (missed <= RIM_M) & (not stopped.acted_before)
    aimed = (at_hand | at_rim) & (closings >= AIMED)
    arrived: Mask = stopped.last & np.asarray(aimed.any(axis=0))
    counted = (at_hand | aimed) & arrived if arrived.any() else at_hand & stopped.last
    fewest = 1 if arrived.any() else max(1, np.count_nonzero(hand.in_segment) / 2)
    touched: Mask = counted.sum(axis=1) >= fewest
    return {
        pair.track.id: float(np.median(missed[row, counted[row]])) for row, pair in enumerate(pairs) if touched[row]
    }


def nudge_m(pair: Comotion) -> float:
    """Measure how far an object gave way within the segment (m, root mean square); 0 where that may be noise.

    The noise is estimated from second differences, which are sqrt(6) times as large.
    """
    positions_m = pair.object_m[pair.hand.in_segment]
    if len(positions_m) < FEWEST_POSITIONS:
        return 0.0
    deviations_m = np.median(np.abs(np.diff(positions_m, 2, axis=0)), axis=0)
    noise_m = float(np.linalg.norm(deviations_m)) / (MAD_TO_STD * np.sqrt(6))
    nudged_m = float(np.linalg.norm(positions_m.std(axis=0)))
    return nudged_m if nudged_m >= max(NUDGE_M, NUDGE_TO_NOISE * noise_m) else 0.0


def _closing(hand: HandTrack, pair: Comotion, since: Indices) -> Array:
    """Measure the share of the hand's last step by which it came nearer to where the object is, 0 to 1 (n,)."""
    steps = np.linalg.norm(hand.positions_m - hand.positions_m[since], axis=1)
    nearer = np.linalg.norm(pair.object_m - hand.positions_m[since], axis=1) - pair.distances_m
    shares = np.divide(nearer, steps, out=np.zeros_like(steps), where=(since >= 0) & (steps > 0))
    closing: Array = np.clip(shares, 0.0, 1.0)
    return closing
