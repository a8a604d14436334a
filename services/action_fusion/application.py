"""What a held object is applied to: the tool is worked at a place of another object's, not carried past it."""

from collections.abc import Sequence

import numpy as np

from action_fusion.comotion import Comotion
from action_fusion.samples import Mask
from action_fusion.settings import Settings

WORKING_M = 0.05
"""What a hand does in one place stays within this of it: stirring, pouring, cutting move by the width of a hand."""

WORKING_SHARE = 0.75


def applied_to(held: Comotion, others: Sequence[Comotion], settings: Settings) -> Comotion | None:
    """Find the object that the held one works at: of several the nearest.

    Over at least three quarters of the time in hand, the held one stays within `WORKING_M` of one place relative to it
    (their median), no further away than a hand grasps.
    """
    instants = _in_hand(held)
    if not instants.any():
        return None
    nearness: list[tuple[float, Comotion]] = []
    for other in others:
        between = (held.object_m - other.object_m)[instants]
        distances = np.linalg.norm(between, axis=1)
        strayed = np.linalg.norm(between - np.median(between, axis=0), axis=1)
        if np.mean((strayed <= WORKING_M) & (distances <= settings.grasp_m)) >= WORKING_SHARE:
            nearness.append((float(np.median(distances)), other))
    return min(nearness, key=lambda near: near[0], default=(0.0, None))[1]


def _in_hand(held: Comotion) -> Mask:
    """Tell the segment's instants from the first on at which the hand moved the object, until it lets go of it."""
    moved = np.flatnonzero(held.with_hand)
    if not len(moved):
        return held.with_hand
    instants = np.arange(len(held.with_hand))
    near = held.distances_m <= np.median(held.distances_m[moved]) + WORKING_M
    in_hand: Mask = near & (instants >= moved[0]) & (held.path.stamps_ns >= 0)
    return in_hand
