"""What axes that are fitted to coordinates leave out: the axes of the model before know it, and keep it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices
from actum_model_trainer.basis import Basis
from actum_model_trainer.ridge import PrimalRidge
from actum_model_trainer.training_data import TrainingData
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel

Linear = list[NDArray[np.float32]]
"""Axes (…, inputs, actions) and offsets (…, actions) of a model's discriminants, second opinion and verifier."""


def with_what_was_left_out(
    model: PyramidModel, before: PyramidModel, data: TrainingData, preset: PyramidPreset
) -> PyramidModel:
    """Return a model with, for the actions before, what the axes before have beside those fitted to coordinates.

    Args:
        model: fitted to coordinates.
        before: the model with fewer actions, fitted to whole vectors, or changed in this way.
        data: the coordinates of what that model was trained on.
        preset: of the training.
    """
    places = [model.labels.index(label) for label in before.labels]
    known, refitted, changed = _linear_of(before), _refitted(data, preset), [each.copy() for each in _linear_of(model)]
    for exact, coarse, now in zip(known, refitted, changed, strict=True):
        now[..., places] += exact - coarse
    axes, offsets, opinion_axes, opinion_offsets, pooled, convolved, verifier_offsets = changed
    return replace(
        model,
        stages=replace(model.stages, axes=axes, offsets=offsets),
        opinion=replace(model.opinion, axes=opinion_axes, offsets=opinion_offsets),
        verifier=replace(model.verifier, pooled_axes=pooled, convolution_axes=convolved, offsets=verifier_offsets),
    )


def _linear_of(model: PyramidModel) -> Linear:
    stages, opinion, verifier = model.stages, model.opinion, model.verifier
    of_verifier = verifier.pooled_axes, verifier.convolution_axes, verifier.offsets
    return [stages.axes, stages.offsets, opinion.axes, opinion.offsets, *of_verifier]


def _refitted(data: TrainingData, preset: PyramidPreset) -> Linear:
    """Fit to coordinates what `_linear_of` lists."""
    last, convolved, weight = data.stages[-1], data.convolved, preset.convolutions.verifier_weight
    of_maps, of_features = data.pooled_basis, data.convolved_basis
    assert of_maps is not None and of_features is not None
    shrinkages, samples = (preset.shrinkage, preset.convolutions.shrinkage), last.sample_indices
    stages = [_fitted(data, each.vectors, each.sample_indices, shrinkages[0], of_maps) for each in data.stages]
    opinion = _fitted(data, convolved.taught, samples, shrinkages[1], of_features)
    maps = _fitted(data, np.concatenate([last.vectors, data.background]), samples, shrinkages[0], of_maps)
    features = np.concatenate([convolved.taught, convolved.background])
    convolutions = _fitted(data, features, samples, shrinkages[1], of_features)
    return [
        np.stack([axes for axes, _ in stages]),
        np.stack([offsets for _, offsets in stages]),
        opinion[0] / convolved.spread[:, None],
        opinion[1],
        maps[0] / (1 + weight),
        weight / (1 + weight) * convolutions[0] / convolved.spread[:, None],
        (maps[1] + weight * convolutions[1]) / (1 + weight),
    ]


def _fitted(
    data: TrainingData, rows: NDArray[np.float32], samples: Indices, shrinkage: float, basis: Basis
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Fit rows (n, rank), of which those beyond the samples' are background; return axes and offsets for inputs."""
    indicators = np.zeros((len(rows), len(data.labels)))
    indicators[np.arange(len(samples)), data.targets[samples]] = 1
    fitted = PrimalRidge(rows, indicators, shrinkage)
    axes = basis.axes(fitted.axes)
    return axes, basis.offsets(fitted.offsets, axes)
