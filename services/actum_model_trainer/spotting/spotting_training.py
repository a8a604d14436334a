"""Training of the search for actions without marks, on a trained recogniser and whole streams.

The heads are trained twice: the second time also on what the first ones took for actions in the background of people
left out. Of all background that part teaches most.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.confidence import averaged_with_prior
from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import background_min
from actum_model_trainer.kept import KeptWindows, pooled_basis
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import digest_of_streams
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.common_head import mixed, mixed_heads
from actum_model_trainer.spotting.heads_training import Folds, window_rows
from actum_model_trainer.spotting.logistic_regression import logistic_fit
from actum_model_trainer.spotting.scanning import ScannedStream, scanned
from actum_model_trainer.spotting.threshold_choice import ThresholdChoice, chosen_threshold, false_alarms
from actum_model_trainer.spotting.training_windows import (
    TrainingWindows,
    training_windows,
    true_completeness,
    with_false_alarms,
)
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.pyramid_spotter import FEWEST_FRAMES
from som_classifier.spotting.spotting_model import PyramidSpottingMetadata, SpottingModel
from som_classifier.spotting.spotting_preset import SpottingPreset

COARSE = 2
"""Intervals between two looks for false alarms to learn from: they last longer, and looking takes most of the time."""
FIRST_VARIANTS = 2
"""Variants of each window that the first heads learn from: they only look for false alarms; n windows cost n³."""
SHORTEST_S = 0.2
"""Shortest window (s): a shorter movement is a twitch."""
MIN_LOG_DURATION_SD = 0.15
"""Of ln(duration / s): people's tempos differ by as much even where the training's do not."""


def with_spotting(
    model: PyramidModel, streams: Sequence[LabelledStream], preset: PyramidPreset, seed: int, progress: Progress
) -> PyramidModel:
    """Return the model with the search, trained on whole streams; as it is where these hold no action or no window.

    Streams of counterexamples are left to the verifier: heads would learn that who acts there never does anything. Few
    people show little of how sure the search has to be of others: their threshold is averaged with the prior's.
    """
    search, rng = preset.spotting, np.random.default_rng(seed)
    usable = usable_streams(streams)
    before = untuned(usable, model.labels, search)
    windows = [training_windows(each, model.labels, np.array(before.window_durations_s), rng) for each in usable]
    if not any(each.completeness.any() for each in windows):
        return model
    folds = Folds(usable, search.folds)
    windows = _with_false_alarms(model, usable, windows, folds, before, preset, rng, progress)
    rows = window_rows(model, usable, windows, folds, preset, rng, progress)
    coordinates, completeness = pooled_basis(model.kept).coordinates(rows.vectors), rows.completeness
    heads, *of_others = rows.heads([None, *range(folds.count)], search.shrinkage)
    del rows
    answered = scanned(model, usable, of_others, folds, before, progress)
    if not any(len(each.windows) for each in answered):
        return model
    share, choice = _chosen(answered, SpottingModel(heads, before), model.labels, preset)
    probability = _probability(_mixed(answered, share), model.labels)
    people = len({stream.person for stream in usable if stream.segments})
    threshold = float(averaged_with_prior(choice.threshold, preset.prior.threshold, preset.prior, people))
    learned = before.model_copy(update=choice.stored | {"threshold": threshold, "probability": probability})
    metadata = model.metadata.model_copy(update={"spotting": learned})
    kept = {**model.kept, **KeptWindows(coordinates, completeness, share, digest_of_background(streams)).arrays}
    return replace(model, heads=mixed_heads(heads, share), metadata=metadata, kept=kept)


def _with_false_alarms(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    windows: Sequence[TrainingWindows],
    folds: Folds,
    untuned: PyramidSpottingMetadata,
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> list[TrainingWindows]:
    """Add windows about what heads that are trained on the others take for actions in background, if there is any."""
    if not untuned.background_s:
        return list(windows)
    search = preset.spotting
    few = min(search.most_windows, FIRST_VARIANTS * sum(len(each.frames) for each in windows))
    less_varied = replace(preset, spotting=replace(search, most_windows=few))
    of_others = window_rows(model, streams, windows, folds, less_varied, rng, progress).heads(
        range(folds.count), search.shrinkage
    )
    coarse = untuned.model_copy(update={"interval_s": COARSE * search.interval_s})
    answered = _mixed(scanned(model, streams, of_others, folds, coarse, progress), search.common_shares[0])
    searching = SpottingModel(of_others[0], untuned)
    alarms = false_alarms(answered, searching, model.labels, search.false_alarm_threshold)
    return [with_false_alarms(*each, rng) for each in zip(streams, windows, alarms, strict=True)]


def usable_streams(streams: Sequence[LabelledStream]) -> list[LabelledStream]:
    """Return the streams that the search learns from: not those of counterexamples, nor those of a few frames."""
    return [each for each in streams if len(each.stamps_ns) >= FEWEST_FRAMES and not each.is_counterexample]


def digest_of_background(streams: Sequence[LabelledStream]) -> str:
    """Return the digest of those streams without an action that the search learns from."""
    return digest_of_streams([each for each in usable_streams(streams) if not each.marked.truths])


def _chosen(
    answered: Sequence[ScannedStream], untuned: SpottingModel, labels: Sequence[str], preset: PyramidPreset
) -> tuple[float, ThresholdChoice]:
    """Choose the common head's share, and with it the threshold, by what is found in streams of people left out."""
    choices = [
        (share, chosen_threshold(_mixed(answered, share), untuned, labels, preset.spotting.thresholds, preset.prior))
        for share in preset.spotting.common_shares
    ]
    return max(choices, key=lambda choice: choice[1].worth)


def _mixed(answered: Sequence[ScannedStream], share: float) -> list[ScannedStream]:
    return [replace(each, completeness=mixed(each.completeness, share)) for each in answered]


def untuned(
    streams: Sequence[LabelledStream], labels: Sequence[str], search: SpottingPreset
) -> PyramidSpottingMetadata:
    """Return the metadata before a threshold is chosen."""
    durations_s, log_means, log_sds = _durations(streams, labels, search)
    marked = Found.of_all(stream.marked for stream in streams)
    return PyramidSpottingMetadata(
        interval_s=search.interval_s,
        lag_s=search.lag_s,
        overlap=search.overlap,
        duration_weight=search.duration_weight,
        window_durations_s=durations_s.tolist(),
        log_duration_means=log_means,
        log_duration_sds=log_sds,
        thresholds=list(search.thresholds),
        false_alarms_per_min=[],
        recalls=[],
        precisions=[],
        threshold=search.thresholds[0],
        probability=[1.0, 0.0],
        background_s=60 * background_min(marked.seen, marked.truths),
    )


def _durations(
    streams: Sequence[LabelledStream], labels: Sequence[str], preset: SpottingPreset
) -> tuple[Array, list[float], list[float]]:
    """Return the windows' durations (s), and mean and standard deviation of each action's log durations."""
    by_label: dict[str, list[float]] = {label: [] for label in labels}
    for stream in streams:
        for start_ns, end_ns, label in stream.segments:
            by_label.get(label, []).append(max((end_ns - start_ns) / SECOND_NS, SHORTEST_S))
    every = [duration_s for of_label in by_label.values() for duration_s in of_label] or [1.0]
    quantiles = np.linspace(preset.shortest_quantile, 1 - preset.shortest_quantile, preset.windows)
    logs = [np.log(of_label or every) for of_label in by_label.values()]
    sds = [max(float(of_label.std()), MIN_LOG_DURATION_SD) for of_label in logs]
    return np.unique(np.quantile(every, quantiles)), [float(of_label.mean()) for of_label in logs], sds


def _probability(scanned: Sequence[ScannedStream], labels: Sequence[str]) -> list[float]:
    """Return the logistic regression of whether the likeliest action of a window is done in it on the head's answer."""
    answers = np.concatenate([each.completeness.max(axis=1) for each in scanned])
    is_right = [
        true_completeness(each.stream, each.windows, labels)[
            np.arange(len(each.windows)), each.completeness.argmax(axis=1)
        ]
        > 0
        for each in scanned
    ]
    return list(logistic_fit(answers, np.concatenate(is_right)))
