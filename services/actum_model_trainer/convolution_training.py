"""The convolutions of the second opinion and the verifier: their coordinates, biases and features."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum_model_trainer.basis import Basis
from actum_model_trainer.discriminants import Discriminants
from actum_model_trainer.products import blocks
from actum_model_trainer.side_by_side import side_by_side
from som_classifier.convolutions import COORDINATES, FILTERS, WEIGHTS, Convolutions, Floats32

AT_ONCE = 128
"""Sequences that are convolved one after the other, beside others."""
GOLDEN = (np.sqrt(5) - 1) / 2
"""Multiples of it modulo 1 are spread evenly over quantiles, however many there are."""


def drawn_convolutions(series: Sequence[Floats32], biases: int, rng: np.random.Generator) -> Convolutions:
    """Draw each filter's coordinates, and its biases as quantiles of its response to a sequence drawn from `series`.

    A filter looks at up to nine coordinates, as often at one or two as at four to nine.
    """
    coordinates = np.zeros((FILTERS, COORDINATES), np.float32)
    for of_filter in coordinates:
        count = int(2 ** rng.uniform(0, np.log2(WEIGHTS + 1)))
        of_filter[rng.choice(COORDINATES, count, replace=False)] = 1
    unbiased = Convolutions(coordinates, np.zeros((FILTERS, 0), np.float32))
    shown = rng.integers(len(series), size=FILTERS)
    responses = unbiased.responses_each([series[number] for number in shown.tolist()])
    quantiles = (GOLDEN * np.arange(1, FILTERS * biases + 1) % 1).reshape(FILTERS, biases)
    drawn = [np.quantile(*each) for each in zip(responses, quantiles, strict=True)]
    return Convolutions(coordinates, np.array(drawn, np.float32).reshape(FILTERS, biases))


def blended(one: Discriminants, other: Discriminants, weight: float) -> Discriminants:
    """Return the first discriminants with weighted means of both ones' scores; the first have weight 1."""
    names = ("training_scores", "cross_validated_scores", "untaught_scores", "background_scores")
    means = {name: (getattr(one, name) + weight * getattr(other, name)) / (1 + weight) for name in names}
    return replace(one, **means)


@dataclass(frozen=True, eq=False)
class Convolved:
    """The features of training sequences and of background, each divided by its standard deviation in training.

    Attributes:
        convolutions: that give them.
        spread: (features,), the standard deviations, 1 of constants.
        taught: (n, features).
        background: (m, features).
    """

    convolutions: Convolutions
    spread: Floats32
    taught: Floats32
    background: Floats32

    @classmethod
    def of(
        cls, taught: Sequence[Floats32], background: Sequence[Floats32], biases: int, rng: np.random.Generator
    ) -> "Convolved":
        """Draw convolutions for resampled sequences, as the classifier reads them, and apply them."""
        convolutions = drawn_convolutions(taught, biases, rng)
        features = features_of(convolutions, taught)
        spread = features.std(axis=0)
        spread[np.ptp(features, axis=0) == 0] = 1.0  # rounding makes the deviation of some constants 3e-8
        return cls(convolutions, spread, features / spread, features_of(convolutions, background) / spread)

    def in_basis(self, basis: Basis) -> "Convolved":
        """Return coordinates in the place of features."""
        coordinates = basis.coordinates(self.taught), basis.coordinates(self.background)
        return Convolved(self.convolutions, self.spread, *coordinates)

    def axes(self, fitted: Discriminants) -> Floats32:
        """Return the axes for features as they are of discriminants that were fitted to these."""
        return (fitted.axes / self.spread[:, None]).astype(np.float32)


def features_of(convolutions: Convolutions, series: Sequence[Floats32]) -> Floats32:
    """Return the features of sequences, (n, features)."""
    features = np.empty((len(series), convolutions.biases.size), np.float32)

    def compute(rows: slice) -> None:
        for number in range(rows.start, rows.stop):
            features[number] = convolutions.features(series[number])

    side_by_side(compute, blocks(len(series), AT_ONCE))
    return features
