"""Gathers what the layers above the first maps are trained on: pools, convolves and measures samples and background."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from actum.arrays import Floats
from actum.messages import NONE
from actum_model_trainer.augmentation import Variant, augmentation_for, variants
from actum_model_trainer.background import negatives_of
from actum_model_trainer.basis import Basis
from actum_model_trainer.convolution_training import Convolved
from actum_model_trainer.pooling import MAX_VECTORS, Pooling, chosen_of
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import actions_of, digest_of_streams
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.training_data import SampleMeasures, TrainingData, duration_s
from som_classifier.convolutions import Floats32, resampled
from som_classifier.first_layer import FirstMaps
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid import Pyramid

Strange = tuple[Sequence[SegmentSample], Sequence[Sequence[Variant]]]
"""Windows of movement that nobody taught, and a single variant of each, as the classifier reads it."""
MANY_DIRECTIONS = 1024
"""Directions in which the vectors of many samples are known: at least 99.7 % of their variance lies in them."""


@dataclass(frozen=True, eq=False)
class Taught:
    """The samples of a training, and what is drawn of them.

    Attributes:
        samples: as measured.
        mirrors: whether an action of the left arm is read as its mirror image.
        augmented: the variants of each sample, the one as measured first.
        rng: as it is after the variants were drawn.
    """

    samples: Sequence[SegmentSample]
    mirrors: bool
    augmented: Sequence[Sequence[Variant]]
    rng: np.random.Generator

    @classmethod
    def of(cls, samples: Sequence[SegmentSample], mirrors: bool, preset: PyramidPreset, seed: int) -> "Taught":
        """Draw the variants.

        Raises:
            TrainingError: fewer than two actions among the samples.
        """
        actions_of(samples)
        rng = np.random.default_rng(seed)
        augmentation = augmentation_for([sample.person for sample in samples], preset)
        augmented = [list(variants(sample, augmentation, mirrors, rng)) for sample in samples]
        return cls(samples, mirrors, augmented, rng)

    def every(self, stride: int) -> list[int]:
        """Return the numbers of every so many samples, in order, spread evenly over each action's."""
        by_action = sorted(range(len(self.samples)), key=lambda number: self.samples[number].label)
        return sorted(by_action[::stride])

    @property
    def measured(self) -> list[Floats]:
        """The postures of each sample as measured."""
        return [of_sample[0].postures for of_sample in self.augmented]


def gathered(
    first: FirstMaps,
    taught: Taught,
    background: Sequence[LabelledStream],
    preset: PyramidPreset,
    seed: int,
    progress: Progress,
) -> TrainingData:
    """Pool, convolve and measure the samples and the background, of many samples as coordinates."""
    pooling = Pooling(first, Pyramid(preset.levels, preset.overlap), taught.mirrors)
    if len(taught.samples) > MAX_VECTORS:
        pooling.basis = _basis_of_some(pooling, taught, preset)
    strange = _background(background, taught.samples, preset, taught.mirrors, seed)
    stages = pooling.vectors(taught.samples, taught.augmented, preset.stages, progress=progress)
    beside, convolved = pooling.of_background(*strange), _convolved(taught, strange, preset, seed)
    measures = SampleMeasures.of(taught.samples, first, taught.measured)
    basis, digest = None, digest_of_streams(background)
    if pooling.basis is not None:
        basis = Basis.of(convolved.taught, MANY_DIRECTIONS)
        convolved = convolved.in_basis(basis)
    return TrainingData(measures, stages, beside, digest, convolved, pooling.basis, basis)


def _basis_of_some(pooling: Pooling, taught: Taught, preset: PyramidPreset) -> Basis:
    """Find the directions of all stages' vectors from samples that are spread evenly over the actions."""
    some = taught.every(-(-len(taught.samples) * len(preset.stages) // (2 * MANY_DIRECTIONS)))
    samples, augmented = [taught.samples[each] for each in some], [taught.augmented[each] for each in some]
    landmarks = pooling.vectors(samples, augmented, preset.stages, beside=len(taught.samples))
    return Basis.of(np.concatenate([stage.vectors for stage in landmarks]), MANY_DIRECTIONS)


def _background(
    streams: Sequence[LabelledStream], samples: Sequence[SegmentSample], preset: PyramidPreset, mirrors: bool, seed: int
) -> Strange:
    """Draw the background's windows, each read as the classifier reads it, counterexamples in all variants.

    A counterexample that is shown in fewer variants than an example counts less than that.
    """
    rng = np.random.default_rng(seed)
    durations_s = np.array([duration_s(sample) for sample in samples])
    windows = negatives_of(streams, durations_s, preset.background, rng)
    shown = [
        (window, variant)
        for window in windows
        for variant in islice(variants(window, preset, mirrors, rng), None if window.label == NONE else 1)
    ]
    return [window for window, _ in shown], [[variant] for _, variant in shown]


def _convolved(taught: Taught, strange: Strange, preset: PyramidPreset, seed: int) -> Convolved:
    """Convolve the same variants that are pooled, and the background."""
    beside = [resampled(window.stamps_ns, variant.postures) for window, (variant,) in zip(*strange, strict=True)]
    shown = series_of(taught.samples, taught.augmented, preset, len(taught.samples))
    return Convolved.of(shown, beside, preset.convolutions.biases, np.random.default_rng(seed))


def series_of(
    samples: Sequence[SegmentSample], augmented: Sequence[Sequence[Variant]], preset: PyramidPreset, everything: int
) -> list[Floats32]:
    """Return the variants that are pooled as complete actions, resampled for the convolutions, in the same order.

    `everything` is how many samples there are, with those that were pooled before.
    """
    chosen = chosen_of(augmented, preset.stages[-1], everything)
    return [
        resampled(sample.stamps_ns, of_sample[variant].postures)
        for sample, of_sample, rows in zip(samples, augmented, chosen, strict=True)
        for _, variant in rows
    ]
