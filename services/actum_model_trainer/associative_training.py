"""Training of the associative map of preset `paper` by the delta rule (Johnsson, Balkenius and Hesslow, 2009)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from actum.arrays import Array, Floats
from actum.som.schedule import falling
from actum_model_trainer.continuation_data import Instants, fitted_shares, instants_of
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import LabelledStream
from som_classifier.associative_som import STORED, AssociativeSom
from som_classifier.continuation import STEPS
from som_classifier.map_continuation import MapContinuation
from som_classifier.paper_model import PaperModel

PRESENTATIONS = 6_000
"""How many instants are shown, each with all parts of the body; with twice as many the error stays the same."""
AT_ONCE = 1_000
"""Instants whose activity is computed at once: each takes 50 kilobytes."""
JUDGED = 2_000
"""Instants that the shares are fitted to, spread evenly."""
RATES = (0.2, 0.01)
"""The share of an error that is corrected at once, at the first presentation and at the last."""
ACTIVE = 0.01
"""Units with a smaller share of the winner's activity count as silent, which leaves about 50 of 900."""


def with_continuation(
    model: PaperModel, streams: Sequence[LabelledStream], seed: int, progress: Progress
) -> PaperModel:
    """Return the model with an associative map on its first map, trained on streams.

    Raises:
        TrainingError: the first map's input is not upright or not from the torso, or no stream is long enough.
    """
    posture, contrast = model.metadata.posture, model.metadata.centre_contrast
    if (posture.axes, posture.origin) != ("upright", "torso"):
        raise TrainingError(
            f"a model with axes={posture.axes} and origin={posture.origin} cannot predict later postures: train a "
            "model with axes=upright and origin=torso"
        )
    instants, no_shares = instants_of(streams), np.zeros((2, len(STEPS)), np.float32)
    untrained = AssociativeSom.untrained(len(model.layer1.weights))
    continuation = MapContinuation(model.layer1, contrast, posture, untrained, no_shares)
    trained = replace(continuation, association=_learnt(continuation, instants, seed, progress))
    judged = instants.at(np.linspace(0, len(instants.postures) - 1, JUDGED).astype(np.intp))
    return replace(model, continuation=replace(trained, shares=fitted_shares(judged, _displacements(trained, judged))))


class AssociationLearning:
    """The weights of an associative map while it learns.

    With x the activities now and one step before, w += β x (y − wᵀx) / ‖x‖², where y is the activity that followed: the
    error is the main activity less the associated one. Units are associated with themselves at first, so that a posture
    that was never seen stays as it is.
    """

    def __init__(self, units: int) -> None:
        self._weights = np.zeros((2 * units, units), np.float32)

    @property
    def learnt(self) -> AssociativeSom:
        """The map as it is now."""
        units = self._weights.shape[1]
        return AssociativeSom(self._weights.reshape(2, units, units).astype(STORED))

    def adapt(self, now: Floats, before: Floats, after: Floats, rate: float) -> None:
        """Learn what followed (units,) activities now and one step before, each with the same sum."""
        inputs = np.concatenate([now, before])
        active = np.flatnonzero(inputs > ACTIVE * inputs.max())
        x = inputs[active].astype(np.float32)
        learnt = self._weights[active]
        error = after - now - x @ learnt
        learnt += np.multiply.outer(np.float32(rate) / (x @ x) * x, error)
        self._weights[active] = learnt


def _learnt(continuation: MapContinuation, instants: Instants, seed: int, progress: Progress) -> AssociativeSom:
    """Return the associations after `PRESENTATIONS` instants, drawn at random."""
    learning, rates = AssociationLearning(len(continuation.som.weights)), falling(*RATES, PRESENTATIONS)
    drawn = np.random.default_rng(seed).integers(len(instants.postures), size=PRESENTATIONS)
    for first in range(0, PRESENTATIONS, AT_ONCE):
        progress("association", first, PRESENTATIONS)
        shown = slice(first, first + AT_ONCE)
        _show(learning, continuation, instants.at(drawn[shown]), rates[shown])
    progress("association", PRESENTATIONS, PRESENTATIONS)
    return learning.learnt


def _show(learning: AssociationLearning, continuation: MapContinuation, shown: Instants, rates: Array) -> None:
    """Show instants, one after the other, each with every part of the body."""
    now, before, after = map(continuation.activities, (shown.postures, shown.before, shown.after))
    for number, rate in enumerate(rates.tolist()):
        for followed in zip(now[:, number], before[:, number], after[:, number], strict=True):
            if all(activity.any() for activity in followed):  # else the part was missing
                learning.adapt(*followed, rate)


def _displacements(continuation: MapContinuation, instants: Instants) -> Array:
    """Return what the map answers at each instant, (n, 3, 15, 3)."""
    now, before = map(continuation.activities, (instants.postures, instants.before))
    return np.stack([continuation.read(now[:, row], before[:, row]) for row in range(len(instants.postures))])
