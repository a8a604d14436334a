"""Heads for the search for added actions: fitted to the coordinates of all windows, those kept and the new streams'.

The threshold, and how probable an action is, stay: they were chosen on streams that the model does not keep.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from actum_model_trainer.basis import Basis
from actum_model_trainer.kept import KeptWindows, pooled_basis
from actum_model_trainer.progress import Progress
from actum_model_trainer.ridge import PrimalRidge
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.common_head import mixed_heads, with_common
from actum_model_trainer.spotting.heads_training import Folds, window_rows
from actum_model_trainer.spotting.spotting_training import untuned, usable_streams
from actum_model_trainer.spotting.training_windows import training_windows
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotting_model import CompletenessHeads, PyramidSpottingMetadata


def with_added_heads(
    before: PyramidModel,
    model: PyramidModel,
    windows: KeptWindows,
    streams: Sequence[LabelledStream],
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> PyramidModel:
    """Return a model with heads for all its actions.

    Args:
        before: the model with fewer actions and their search.
        model: with all actions.
        windows: that the search was trained on, in the basis of the model with all actions.
        streams: that hold the new examples.
        preset: of the training.
        rng: draws windows.
        progress: of the training.
    """
    known, usable = before.metadata.spotting, usable_streams(streams)
    assert known is not None
    learned = _learned(before.labels, model.labels, known, usable, preset)
    known_windows = windows.with_labels(before.labels, model.labels)
    every = known_windows
    if usable:
        drawn = [training_windows(each, model.labels, np.array(learned.window_durations_s), rng) for each in usable]
        as_many = _as_often(preset, model.metadata.samples / before.metadata.samples - 1)
        rows = window_rows(model, usable, drawn, Folds(usable, 1), as_many, rng, progress)
        every = every.and_also(pooled_basis(model.kept).coordinates(rows.vectors), rows.completeness)
    shrinkage = preset.spotting.shrinkage
    fitted, without = (_heads(each, pooled_basis(model.kept), shrinkage) for each in (every, known_windows))
    places = [model.labels.index(label) for label in before.labels]
    metadata = model.metadata.model_copy(update={"spotting": learned})
    heads = _changed(before, places, fitted, without)
    return replace(model, heads=heads, metadata=metadata, kept={**model.kept, **every.arrays})


def _heads(windows: KeptWindows, basis: Basis, shrinkage: float) -> CompletenessHeads:
    """Fit the actions' heads and the common one to the windows' coordinates, and mix them."""
    fitted = PrimalRidge(windows.coordinates, with_common(windows.completeness), shrinkage)
    axes = basis.axes(fitted.axes)
    return mixed_heads(CompletenessHeads(axes, basis.offsets(fitted.offsets, axes)), windows.share)


def _changed(
    before: PyramidModel, places: Sequence[int], fitted: CompletenessHeads, without: CompletenessHeads
) -> CompletenessHeads:
    """Return the heads before, changed as the new windows change heads that are fitted to coordinates.

    Coordinates leave out something, which the heads before know.

    Args:
        before: the model with fewer actions.
        places: the numbers of its actions among all.
        fitted: to all windows.
        without: fitted to the windows before.
    """
    assert before.heads is not None
    axes, offsets = fitted.axes.copy(), fitted.offsets.copy()
    axes[:, places] += before.heads.axes - without.axes[:, places]
    offsets[places] += before.heads.offsets - without.offsets[places]
    return CompletenessHeads(axes, offsets)


def _as_often(preset: PyramidPreset, share: float) -> PyramidPreset:
    """Return the preset that draws new windows as often as those kept were: this share of their number."""
    return replace(preset, spotting=replace(preset.spotting, most_windows=round(share * preset.spotting.most_windows)))


def _learned(
    before: Sequence[str],
    labels: Sequence[str],
    known: PyramidSpottingMetadata,
    streams: Sequence[LabelledStream],
    preset: PyramidPreset,
) -> PyramidSpottingMetadata:
    """Return the metadata with the durations of new actions; shorter and longer windows are added for them."""
    of_new = untuned(streams, labels, preset.spotting)
    mean = dict(zip(labels, of_new.log_duration_means, strict=True)) | dict(
        zip(before, known.log_duration_means, strict=True)
    )
    sd = dict(zip(labels, of_new.log_duration_sds, strict=True)) | dict(
        zip(before, known.log_duration_sds, strict=True)
    )
    shortest_s, longest_s = known.window_durations_s[0], known.window_durations_s[-1]
    shorter = [each for each in of_new.window_durations_s if each < shortest_s]
    longer = [each for each in of_new.window_durations_s if each > longest_s]
    return known.model_copy(
        update={
            "log_duration_means": [mean[label] for label in labels],
            "log_duration_sds": [sd[label] for label in labels],
            "window_durations_s": [*shorter[:1], *known.window_durations_s, *longer[-1:]],
            "background_s": known.background_s + of_new.background_s,
        }
    )
