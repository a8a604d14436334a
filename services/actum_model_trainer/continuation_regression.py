"""Training of the default preset's continuation: ridge regression of displacements, of low rank."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.skeletons import JOINTS
from actum_model_trainer.continuation_data import Instants, fitted_shares, instants_of
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import LabelledStream
from som_classifier.continuation import STEPS
from som_classifier.first_layer import FirstMaps, frame_inputs
from som_classifier.pyramid_model import PyramidModel
from som_classifier.regressed_continuation import ANSWERS, INPUTS, RegressedContinuation

PENALTY = 0.1
"""Of the squared axes, for inputs of variance 1 each."""
ACTIVITY_WEIGHT = 1.0
"""The variance of all activity together, relative to that of all components of posture and velocity."""
RANK = 48
"""Directions that are kept of 135: of MSRC-12 they hold 99.8 % of the squared answers, 24 directions 98.7 %."""
FOLDS = 3
"""Of people, or of streams where there is one person, for the shares: held-out displacements are smaller."""
SMALLEST_SD_M = 1e-3
"""A component that varies less (m) is noise and is not made larger."""
CHUNK = 2_000
"""Instants whose activity is computed at once: each takes some kilobytes."""


def with_continuation(
    model: PyramidModel, streams: Sequence[LabelledStream], _seed: int, progress: Progress
) -> PyramidModel:
    """Return the model with a regression on what its first layer answers, trained on streams.

    Raises:
        TrainingError: no stream is long enough.
    """
    instants = instants_of(streams)
    progress("continuation", 0, FOLDS + 1)
    inputs = _Inputs.of(model.first, instants)
    folds = np.unique(instants.groups, return_inverse=True)[1] % FOLDS
    members = [np.flatnonzero(folds == fold) for fold in range(FOLDS)]
    moments = [_Moments.of(inputs.rows[rows], instants.at(rows)) for rows in members]
    regression, held_out = _regression(sum(moments[1:], moments[0])), np.zeros_like(instants.later)
    for fold, rows in enumerate(members):
        others = [each for number, each in enumerate(moments) if number != fold and each.counts[0]]
        fitted = _regression(sum(others[1:], others[0])) if others else regression
        held_out[rows] = fitted.answers(inputs.rows[rows])
        progress("continuation", fold + 1, FOLDS + 1)
    return replace(model, continuation=_continuation(inputs, regression, fitted_shares(instants, held_out)))


@dataclass(frozen=True, eq=False)
class _Inputs:
    """What displacements are regressed on.

    Attributes:
        usual: (90,), mean of posture and velocity.
        scales: (inputs - 1,), by which inputs are multiplied.
        rows: (n, inputs), posture and velocity less the usual ones, and activity, multiplied by these; and 1.
    """

    usual: NDArray[np.float32]
    scales: NDArray[np.float32]
    rows: NDArray[np.float32]

    @classmethod
    def of(cls, first: FirstMaps, instants: Instants) -> "_Inputs":
        """Compute the inputs of all instants; what is missing counts as usual."""
        seen = frame_inputs(instants.postures, instants.velocities)
        known = ~np.isnan(seen)
        usual = (np.where(known, seen, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)).astype(np.float32)
        centred = np.where(known, seen - usual, 0.0).astype(np.float32)
        chunks = range(0, len(seen), CHUNK)
        active = np.concatenate(
            [
                first.activities(instants.postures[at : at + CHUNK], instants.velocities[at : at + CHUNK])
                for at in chunks
            ]
        ).astype(np.float32)
        scale = np.sqrt(ACTIVITY_WEIGHT * INPUTS / max(float(active.var(axis=0).sum()), 1e-9))
        scales = np.concatenate(
            [1 / np.maximum(centred.std(axis=0), SMALLEST_SD_M), np.full(active.shape[1], scale)]
        ).astype(np.float32)
        ones = np.ones((len(seen), 1), np.float32)
        return cls(usual, scales, np.concatenate([np.concatenate([centred, active], axis=1) * scales, ones], axis=1))


@dataclass(frozen=True, eq=False)
class _Moments:
    """Sums over instants for each horizon, over those of which it is known.

    Attributes:
        products: (3, inputs, inputs), of the inputs with each other; the last input is 1.
        with_answers: (3, inputs, 45), of the inputs with the displacements.
        counts: (3,), how many instants.
    """

    products: Array
    with_answers: Array
    counts: Indices

    @classmethod
    def of(cls, rows: NDArray[np.float32], instants: Instants) -> "_Moments":
        """Sum up rows (n, inputs) and displacements; instants of the same reach are summed once for all horizons."""
        horizons, inputs = len(STEPS), rows.shape[1]
        products = np.zeros((horizons, inputs, inputs))
        with_answers, counts = np.zeros((horizons, inputs, ANSWERS // horizons)), np.zeros(horizons, np.intp)
        for reach in range(1, horizons + 1):
            alike = rows[instants.reach == reach]
            moved = instants.moved[instants.reach == reach].astype(np.float32)
            products[:reach] += alike.T @ alike
            counts[:reach] += len(alike)
            for horizon in range(reach):
                with_answers[horizon] += alike.T @ moved[:, horizon].reshape(len(alike), with_answers.shape[2])
        return cls(products, with_answers, counts)

    def __add__(self, other: "_Moments") -> "_Moments":
        sums = self.products + other.products, self.with_answers + other.with_answers, self.counts + other.counts
        return _Moments(*sums)


@dataclass(frozen=True, eq=False)
class _Regression:
    """Answers = rows · axes · directions; the last input is 1.

    Attributes:
        axes: (inputs, rank).
        directions: (rank, 135).
    """

    axes: Array
    directions: Array

    def answers(self, rows: NDArray[np.float32]) -> Array:
        """Return the displacements (n, 3, 15, 3) for rows (n, inputs)."""
        answers: Array = rows @ self.axes @ self.directions
        return answers.reshape(len(rows), len(STEPS), len(JOINTS), 3)


def _regression(moments: _Moments) -> _Regression:
    """Fit each horizon, then keep the directions of all horizons in which the answers vary most."""
    penalty = PENALTY * np.eye(len(moments.products[0]))
    penalty[-1, -1] = 1e-9
    each = zip(moments.products, moments.with_answers, np.maximum(moments.counts, 1), strict=True)
    axes = np.concatenate(
        [np.linalg.solve(products / count + penalty, answers / count) for products, answers, count in each], axis=1
    )
    varied = axes.T @ (moments.products[0] / moments.counts[0]) @ axes
    directions = np.linalg.eigh(varied)[1][:, : -RANK - 1 : -1].T
    return _Regression(axes @ directions.T, directions)


def _continuation(inputs: _Inputs, regression: _Regression, shares: NDArray[np.float32]) -> RegressedContinuation:
    axes = (regression.axes[:-1] * inputs.scales[:, None]).astype(np.float32)
    offsets = (regression.axes[-1] @ regression.directions).astype(np.float32)
    return RegressedContinuation(inputs.usual, axes, regression.directions.astype(np.float32), offsets, shares)
