"""What continuations learn from: postures at even steps of time, what preceded them, and what followed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.node import SECOND_NS
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import LabelledStream
from som_classifier.continuation import STEP_NS, STEPS
from som_classifier.kinematics import GAP_NS, as_measured

GRID = 2
"""Instants per step: people move on within a step."""
MOST_INSTANTS = 12_000
"""Instants that are learnt from, drawn evenly from all streams: half an hour at 8 a second."""
SMALLEST_DISTANCE_M = 0.005
"""Smaller distances count as this where their inverse is a weight: less than the noise of a sensor."""
ROUNDS = 6
"""Of the fit of shares; the last ones change them by less than a hundredth."""
LEAST_SHARE, LARGEST_SHARE = 0.0, 2.0
"""Bounds of the shares: a movement is not turned round, nor more than doubled."""


@dataclass(frozen=True, eq=False)
class Instants:
    """Instants of streams with all that is known of what preceded and followed.

    Attributes:
        postures: (n, 15, 3), smoothed, NaN where missing.
        velocities: (n, 15, 3), of the postures.
        before: (n, 15, 3), the postures one step before.
        after: (n, 15, 3), the postures one step later.
        measured: (n, 15, 3), about the postures before smoothing.
        later: (n, 3, 15, 3), the same after each horizon; NaN also where the stretch ends before it.
        reach: (n,), how many of the horizons lie within the stretch, at least the first.
        groups: (n,), a number for each person, or for each stream where there is one person.
    """

    postures: Array
    velocities: Array
    before: Array
    after: Array
    measured: Array
    later: Array
    reach: Indices
    groups: Indices

    def at(self, rows: Indices) -> "Instants":
        """Return some of the instants, in this order."""
        return Instants(*[getattr(self, each.name)[rows] for each in fields(self)])

    @property
    def moved(self) -> Array:
        """How far each joint moves until each horizon, (n, 3, 15, 3), 0 where that is not known."""
        return np.nan_to_num(self.later - self.measured[:, None])


def instants_of(streams: Sequence[LabelledStream]) -> Instants:
    """Return the instants of streams from which a whole step is known back and ahead.

    Raises:
        TrainingError: there is none.
    """
    groups = _groups(streams)
    found = [
        (*arrays, np.full(len(arrays[0]), group))
        for stream, group in zip(streams, groups, strict=True)
        for arrays in _of_stream(stream)
    ]
    if not found:
        raise TrainingError(
            "the recordings are too short to train the prediction of later postures: record a person for at least "
            f"{2 * STEP_NS / SECOND_NS:g} s without a break"
        )
    joined = [np.concatenate(each) for each in zip(*found, strict=True)]
    count = len(joined[0])
    chosen = np.linspace(0, count - 1, min(count, MOST_INSTANTS)).astype(np.intp)
    return Instants(*[each[chosen] for each in joined])


def _groups(streams: Sequence[LabelledStream]) -> list[int]:
    people = sorted({stream.person for stream in streams})
    return list(range(len(streams))) if len(people) < 2 else [people.index(stream.person) for stream in streams]


def _of_stream(stream: LabelledStream) -> Iterator[tuple[NDArray[Any], ...]]:
    """Yield the arrays of each stretch without a break, in the order of `Instants`."""
    breaks = np.flatnonzero(np.diff(stream.stamps_ns) > GAP_NS) + 1
    for run in np.split(np.arange(len(stream.stamps_ns)), breaks):
        stamps_ns = stream.stamps_ns[run]
        at_ns = np.arange(stamps_ns[0], stamps_ns[-1] + 1, STEP_NS // GRID) if len(run) else stamps_ns
        first, last = GRID, len(at_ns) - GRID
        if last > first:
            postures = _at(at_ns, stamps_ns, stream.postures[run])
            velocities = _at(at_ns, stamps_ns, stream.velocities[run])
            measured, now = as_measured(postures, velocities), np.arange(first, last)
            later, reach = _followed(measured, now)
            around = postures[now - GRID], postures[now + GRID]
            yield postures[now], velocities[now], *around, measured[now], later, reach


def _followed(measured: Array, now: Indices) -> tuple[Array, Indices]:
    """Return what followed after each horizon, NaN beyond the end, and how many horizons end before it."""
    beyond = np.full((GRID * STEPS[-1], *measured.shape[1:]), np.nan)
    padded, ends = np.concatenate([measured, beyond]), now[:, None] + GRID * np.array(STEPS)
    return padded[ends], (ends < len(measured)).sum(axis=1)


def _at(at_ns: NDArray[np.int64], stamps_ns: NDArray[np.int64], values: Array) -> Array:
    """Interpolate values (n, 15, 3) of stamps at others."""
    columns = values.reshape(len(values), -1).T
    seconds, known = (at_ns - stamps_ns[0]) / SECOND_NS, (stamps_ns - stamps_ns[0]) / SECOND_NS
    return np.stack([np.interp(seconds, known, column) for column in columns], axis=1).reshape(-1, *values.shape[1:])


def fitted_shares(instants: Instants, displacements: Array) -> NDArray[np.float32]:
    """Return the shares (2, 3) of a continuation with which the mean distance of joints from the true ones is least.

    Least squares, in which each joint of each instant is weighed by the inverse of the distance that is left (IRLS).

    Args:
        instants: n of them.
        displacements: (n, 3, 15, 3), that the continuation answers.
    """
    removed = np.nan_to_num(instants.measured - instants.postures)
    shares = np.zeros((2, len(STEPS)), np.float32)
    for horizon in range(len(STEPS)):
        known = instants.reach > horizon
        ahead = np.nan_to_num(instants.later[known, horizon] - instants.postures[known])
        parts = np.stack([displacements[known, horizon], removed[known]], axis=-1).reshape(-1, 3, 2)
        shares[:, horizon] = _of_least_distance(parts, ahead.reshape(-1, 3))
    return shares


def _of_least_distance(parts: Array, ahead: Array) -> Array:
    """Return the factors (2,) of parts (n, 3, 2) whose sum is nearest to (n, 3)."""
    weights, factors = np.ones(len(ahead)), np.zeros(2)
    for _ in range(ROUNDS):
        weighed = parts * weights[:, None, None]
        products = np.einsum("nki,nkj->ij", weighed, parts)
        products += 1e-9 * max(float(np.trace(products)), 1e-9) * np.eye(2)
        factors = np.linalg.solve(products, np.einsum("nki,nk->i", weighed, ahead))
        left_m = np.sqrt(np.square(ahead - parts @ factors).sum(axis=1))
        weights = 1 / np.maximum(left_m, SMALLEST_DISTANCE_M)
    return np.clip(factors, LEAST_SHARE, LARGEST_SHARE)
