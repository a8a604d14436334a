"""Training of the verifier: its axes, and the probability that its likeness stands for."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum_model_trainer.confidence import averaged_with_prior, expected_log_errors
from actum_model_trainer.convolution_training import blended
from actum_model_trainer.discriminants import Discriminants, FittedStage
from actum_model_trainer.spotting.logistic_regression import logistic_fit
from actum_model_trainer.training_data import TrainingData
from som_classifier.presets import Prior, PyramidPreset
from som_classifier.verifier import Verifier

STRANGE_QUANTILE = 0.9
"""Quantile of the likeness of what was scored without its action, by which models of few people differ: with more
examples everything scores higher."""
LEAST_QUANTILE = 0.05
"""Smallest such quantile that counts: a model of two actions may score all else below 0."""
STRANGE_SHARE = 0.25
"""How often a marked segment is assumed to be an action that nobody taught, and how often any other movement, for each
that is taught."""


def trained_verifier(
    labelled: FittedStage, maps: Discriminants, convolutions: Discriminants, data: TrainingData, preset: PyramidPreset
) -> Verifier:
    """Return a verifier that holds the actions against one another and against the background.

    Args:
        labelled: the complete actions, with the scores that name them.
        maps: fitted to the pooled vectors of complete actions and background.
        convolutions: fitted to the features of both.
        data: of the training.
        preset: with hyperparameters and the prior.
    """
    convolved, measures, weight = data.convolved, data.measures, preset.convolutions.verifier_weight
    likenesses, people = Likenesses.of(labelled, blended(maps, convolutions, weight)), measures.everybody
    slope, intercept = verification(likenesses, preset.prior, people)
    return Verifier(
        (maps.axes / (1 + weight)).astype(np.float32),
        (weight / (1 + weight) * convolved.axes(convolutions)).astype(np.float32),
        ((maps.offsets + weight * convolutions.offsets) / (1 + weight)).astype(np.float32),
        expected_log_errors(measures.log_errors, data.targets, preset.prior),
        slope,
        intercept,
        *least_likenesses(likenesses, preset, people, measures.one_sample_each),
    )


@dataclass(frozen=True, eq=False)
class Likenesses:
    """How like the action that each is called the vectors of a training are.

    Attributes:
        taught: (n,), by discriminants fitted without the vector's person.
        is_right: (n,), whether these are called what they are.
        untaught: (n,), of the same vectors by discriminants fitted without their action.
        background: (m,), of the background's.
    """

    taught: Array
    is_right: NDArray[np.bool_]
    untaught: Array
    background: Array

    @classmethod
    def of(cls, labelled: FittedStage, verifying: Discriminants) -> "Likenesses":
        """Look up the verifier's scores of the actions that the labelled scores name."""
        naming, row = labelled.discriminants, np.arange(len(labelled.targets))
        named, misnamed = naming.cross_validated_scores.argmax(axis=1), naming.untaught_scores.argmax(axis=1)
        return cls(
            verifying.cross_validated_scores[row, named],
            named == labelled.targets,
            verifying.untaught_scores[row, misnamed],
            verifying.background_scores.max(axis=1, initial=-np.inf),
        )


def verification(of: Likenesses, prior: Prior, people: int) -> tuple[float, float]:
    """Return slope and intercept of the logistic regression of whether a segment is a true instance of its action.

    Instances are what was taught, scored without its person. What is none are the same, scored without their action,
    and the background. Each of these kinds counts as much as a quarter of what was taught. Few people show little of
    that, so the regression is averaged with the prior's, in which the likeness of untaught actions scales that of all.
    """
    groups, shares = (of.taught, of.untaught, of.background), (1.0, STRANGE_SHARE, STRANGE_SHARE)
    is_right = np.concatenate([of.is_right, np.zeros(len(of.untaught) + len(of.background), dtype=bool)])
    counts = [
        np.full(len(group), share * len(of.taught) / max(len(group), 1))
        for group, share in zip(groups, shares, strict=True)
    ]
    own = logistic_fit(np.concatenate(groups), is_right, np.concatenate(counts))
    slope, intercept = prior.verification
    strange = max(float(np.quantile(of.untaught, STRANGE_QUANTILE)), LEAST_QUANTILE)
    expected = slope / math.sqrt(strange), intercept
    found = averaged_with_prior(np.array(own), np.array(expected), prior, people)
    return float(found[0]), float(found[1])


def least_likenesses(of: Likenesses, preset: PyramidPreset, people: int, one_sample_each: bool) -> tuple[float, float]:
    """Return the likenesses that shares of true instances exceed: `preset.known_share`, and `preset.found_share`.

    The quantiles of what was taught, scored without its person and rightly called, are averaged with the prior's.
    """
    prior = preset.prior
    expected = prior.least_from_one if one_sample_each else prior.least_likeness
    taught = of.taught[of.is_right] if of.is_right.any() else of.taught
    own = np.quantile(taught, [1 - preset.known_share, 1 - preset.found_share])
    known, found = averaged_with_prior(own, np.array(expected), prior, people)
    return float(known), float(found)
