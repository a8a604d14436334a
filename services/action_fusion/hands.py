"""Where the actor's hands were, in the camera's frame: there a thing that nobody moves stays where it is.

Distances are the same in it as in the egocentric frame, which is a rigid transform of it at every instant.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.proximity import ARMS, Actor
from action_fusion.samples import Array, Indices
from actum.messages import Hand
from actum.node import SECOND_NS

MOST_INSTANTS = 600
SMOOTHING_NS = SECOND_NS // 10
"""Positions are averaged over this long before and after: a joint's noise of a centimetre becomes four millimetres."""

SPEED_NS = SECOND_NS // 10
"""A speed is measured over this long before and after, in which a joint's noise of a centimetre is 7 cm/s."""


FURTHEST_SHARE = 0.8


@dataclass(frozen=True)
class HandPath:
    """A hand's known instants: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera frame."""

    hand: Hand
    stamps_ns: Array
    positions_m: Array

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate linearly, holding the first and the last: (p,) to (p, 3); NaN where the hand was never known."""
        if not len(self.stamps_ns):
            return np.full((len(stamps_ns), 3), np.nan)
        return np.stack([np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T], axis=1)

    def speeds(self) -> Array:
        """Measure the speed (n,) in m/s over a fifth of a second around each instant."""
        before, after = self.stamps_ns - SPEED_NS, self.stamps_ns + SPEED_NS
        if not len(self.stamps_ns):
            return np.empty(0)
        first, last = self.stamps_ns[0], self.stamps_ns[-1]
        elapsed_s = (np.minimum(after, last) - np.maximum(before, first)) / SECOND_NS
        moved: Array = np.linalg.norm(self.at(after) - self.at(before), axis=1)
        speeds: Array = np.divide(moved, elapsed_s, out=np.zeros_like(moved), where=elapsed_s > 0)
        return speeds


@dataclass(frozen=True)
class Hands:
    """The actor's hands that are known, and those of the others who are there."""

    own: Mapping[Hand, HandPath]
    others: Sequence[HandPath] = ()

    @property
    def everybodys(self) -> list[HandPath]:
        """All of them, the actor's first."""
        return [*self.own.values(), *self.others]


def hand_path(actor: Actor, hand: Hand) -> HandPath:
    """Take one hand of an actor's postures; of very many instants every so-many-th."""
    in_ego = actor.joints_m[:, ARMS[hand][1]] - actor.translations
    positions = np.einsum("pji,pj->pi", actor.rotations, in_ego)
    known = np.flatnonzero(np.isfinite(positions).all(axis=1))
    stamps, places = actor.stamps_ns[known], smoothed(positions[known], actor.stamps_ns[known])
    stride = max(1, math.ceil(len(known) / MOST_INSTANTS))
    return HandPath(hand, stamps[::stride], places[::stride])


def smoothed(positions_m: Array, stamps_ns: Array) -> Array:
    """Average positions (n, 3) over a fifth of a second around each, less at both ends."""
    if not len(positions_m):
        return positions_m
    here = np.arange(len(stamps_ns))
    before = here - np.searchsorted(stamps_ns, stamps_ns - SMOOTHING_NS)
    after = np.searchsorted(stamps_ns, stamps_ns + SMOOTHING_NS, side="right") - 1 - here
    half = np.minimum(before, after)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(positions_m, axis=0)])
    mean: Array = (sums[here + half + 1] - sums[here - half]) / (2 * half + 1)[:, None]
    return mean


def departures(positions_m: Array, step_m: float) -> Indices:
    """Find, for each instant, the last one before it at which the thing was `step_m` or more from where it is now.

    Returns:
        indices (n,), -1 where there is none.
    """
    found = np.full(len(positions_m), -1, dtype=np.int64)
    for i, place in enumerate(positions_m):
        away = np.flatnonzero(np.linalg.norm(positions_m[:i] - place, axis=1) >= step_m)
        if len(away):
            found[i] = away[-1]
    return found


def furthest(positions_m: Array, stamps_ns: Array, within_ns: float) -> Indices:
    """Find, for each instant, when in the last `within_ns` the thing was about furthest from where it is now.

    That is the last instant with at least four fifths of the greatest distance: a thing that was still has left.
    Positions are (T, 3), stamps (T,), and so are the indices found.
    """
    if not len(positions_m):
        return np.empty(0, dtype=np.int64)
    here = np.arange(len(positions_m))
    earliest = np.searchsorted(stamps_ns, stamps_ns - within_ns)
    window = earliest[:, None] + np.arange((here - earliest).max() + 1)
    away = np.linalg.norm(positions_m[np.minimum(window, here[:, None])] - positions_m[:, None], axis=2)
    far = (away >= FURTHEST_SHARE * away.max(axis=1, keepdims=True)) & (window <= here[:, None])
    last: Indices = window[here, far.shape[1] - 1 - np.argmax(far[:, ::-1], axis=1)]
    return last
