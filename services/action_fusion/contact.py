"""Which object a hand has reached for, where it has moved none: by closeness, and by where the reach was heading."""

from collections.abc import Mapping, Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.hands import HandPath, departures
from action_fusion.samples import Array, Indices, Mask
from action_fusion.settings import Settings
from action_fusion.stops import stops

REACH_STEP_M = 0.05
"""The last of a reach, by which its goal is told: several times a joint's noise, less than a hand's breadth."""

NUDGE_M = 0.001
"""A thing that is touched gives way by more; less is the table's trembling."""

NUDGE_TO_NOISE = 5.0
FEWEST_PLACES = 10
GAUSSIAN = 0.6745
"""The median of absolute deviations, in standard deviations."""

TOUCHED_M = 0.13
"""A hand that has acted elsewhere is at a thing only if it touches it: from the palm to the fingertips, and half of a
small thing."""

RIM_M = 0.10
"""A hand that stops further from a thing's middle than a grasp is at its rim if it went for it: its way passes within
half of a thing of two decimetres."""

AIMED = 0.5
"""A reach heads at an object where at least half of its last step brought the hand nearer to it: within 60 degrees."""


def misses_m(path: HandPath, pairs: Sequence[Comotion], settings: Settings) -> Mapping[int, float]:
    """Measure by how much the hand misses each object that it may have reached, by the object's id.

    A reach ends on a line to its goal. With c = (r' - r) / s the share of the hand's last step s by which the
    distance r fell, the line of the step passes the object at r sqrt(1 - c^2); a hand that made no such step, or
    moved away, misses it by r. The median over the instants at which the hand rests where it works last, with the
    object in grasp, or at its rim if it went for it, is taken: those to which a reach for any object has led or, where
    none was seen to, all, if they are most of the segment. A hand that has stopped elsewhere before has acted there,
    and on nothing, for nothing was moved: it has to touch what it is to have reached for.
    """
    if not pairs:
        return {}
    since = departures(path.positions_m, REACH_STEP_M)
    closings = np.stack([_closing(path, pair, since) for pair in pairs])
    distances = np.stack([pair.distances_m for pair in pairs])
    stopped = stops(path)
    missed = distances * np.sqrt(1 - closings**2)
    at_hand = distances <= (TOUCHED_M if stopped.acted_before else settings.grasp_m)
    at_rim = (distances <= settings.reach_m) & (missed <= RIM_M) & (not stopped.acted_before)
    aimed = (at_hand | at_rim) & (closings >= AIMED)
    arrived: Mask = stopped.last & np.asarray(aimed.any(axis=0))
    counted = (at_hand | aimed) & arrived if arrived.any() else at_hand & stopped.last
    fewest = 1 if arrived.any() else max(1, np.count_nonzero(path.stamps_ns >= 0) / 2)
    touched: Mask = counted.sum(axis=1) >= fewest
    return {
        pair.track.id: float(np.median(missed[row, counted[row]])) for row, pair in enumerate(pairs) if touched[row]
    }


def gives_way_m(pair: Comotion) -> float:
    """Measure how far an object was nudged within the segment (m, root mean square); 0 where that may be noise.

    Noise is told by second differences, which are sqrt(6) times as large as it.
    """
    places = pair.object_m[pair.path.stamps_ns >= 0]
    if len(places) < FEWEST_PLACES:
        return 0.0
    noise_m = float(np.linalg.norm(np.median(np.abs(np.diff(places, 2, axis=0)), axis=0))) / (GAUSSIAN * np.sqrt(6))
    nudge_m = float(np.linalg.norm(places.std(axis=0)))
    return nudge_m if nudge_m >= max(NUDGE_M, NUDGE_TO_NOISE * noise_m) else 0.0


def _closing(path: HandPath, pair: Comotion, since: Indices) -> Array:
    """Measure the share of the hand's last step by which it came nearer to where the object is, 0 to 1 (n,)."""
    steps = np.linalg.norm(path.positions_m - path.positions_m[since], axis=1)
    nearer = np.linalg.norm(pair.object_m - path.positions_m[since], axis=1) - pair.distances_m
    shares = np.divide(nearer, steps, out=np.zeros_like(steps), where=(since >= 0) & (steps > 0))
    closing: Array = np.clip(shares, 0.0, 1.0)
    return closing
