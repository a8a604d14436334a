"""Tool use: a held object stays at one place relative to another object, instead of being transported past it."""

from collections.abc import Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.settings import Settings
from actum.arrays import Mask

WORKING_M = 0.05
"""Largest deviation of a tool in use from one place: stirring, pouring and cutting move by the width of a hand."""

WORKING_SHARE = 0.75
"""Least share of the time in hand in which a tool is in use: it is also brought to the target and taken away."""


def tool_target(held: Comotion, others: Sequence[Comotion], settings: Settings) -> Comotion | None:
    """Find the object that the held object is used on, the nearest of several; None where there is none.

    For at least three quarters of the time in hand, the held object stays within `WORKING_M` of its median position
    relative to the target, and no further from the target than `grasp_m`.
    """
    instants = _in_hand(held)
    if not instants.any():
        return None
    nearness: list[tuple[float, Comotion]] = []
    for other in others:
        between_m = (held.object_m - other.object_m)[instants]
        distances_m = np.linalg.norm(between_m, axis=1)
        deviations_m = np.linalg.norm(between_m - np.median(between_m, axis=0), axis=1)
        if np.mean((deviations_m <= WORKING_M) & (distances_m <= settings.grasp_m)) >= WORKING_SHARE:
            nearness.append((float(np.median(distances_m)), other))
    return min(nearness, key=lambda near: near[0], default=(0.0, None))[1]


def _in_hand(held: Comotion) -> Mask:
    """Mask (n,) of the segment's instants at which the object is in the hand, since the hand first moved it."""
    moved = np.flatnonzero(held.with_hand)
    if not len(moved):
        return held.with_hand
    instants = np.arange(len(held.with_hand))
    near = held.distances_m <= np.median(held.distances_m[moved]) + WORKING_M
    in_hand: Mask = near & (instants >= moved[0]) & held.hand.in_segment
    return in_hand
