"""Tool use: a held object is worked at one place of another object, not transported past it."""

from collections.abc import Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.settings import Settings
from actum.arrays import Mask

WORKING_M = 0.05
"""A tool in use stays within this of one place: stirring, pouring and cutting move by the width of a hand."""

WORKING_SHARE = 0.75
"""Of the time in hand: what is worked with is also brought there and taken away."""


def tool_target(held: Comotion, others: Sequence[Comotion], settings: Settings) -> Comotion | None:
    """Find the object that the held one is used on: of several the nearest.

    Over at least three quarters of the time in hand, the held one stays within `WORKING_M` of one place relative to it
    (their median), no further away than a hand grasps.
    """
    instants = _in_hand(held)
    if not instants.any():
        return None
    nearness: list[tuple[float, Comotion]] = []
    for other in others:
        between_m = (held.object_m - other.object_m)[instants]
        distances_m = np.linalg.norm(between_m, axis=1)
        strayed_m = np.linalg.norm(between_m - np.median(between_m, axis=0), axis=1)
        if np.mean((strayed_m <= WORKING_M) & (distances_m <= settings.grasp_m)) >= WORKING_SHARE:
            nearness.append((float(np.median(distances_m)), other))
    return min(nearness, key=lambda near: near[0], default=(0.0, None))[1]


def _in_hand(held: Comotion) -> Mask:
    """Tell the segment's instants (n,) from the first on at which the hand moved the object, until it releases it."""
    moved = np.flatnonzero(held.with_hand)
    if not len(moved):
        return held.with_hand
    instants = np.arange(len(held.with_hand))
    near = held.distances_m <= np.median(held.distances_m[moved]) + WORKING_M
    in_hand: Mask = near & (instants >= moved[0]) & held.hand.in_segment
    return in_hand
