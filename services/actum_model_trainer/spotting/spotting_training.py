"""Training of the search for actions without marks, on a trained recogniser and whole streams."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.node import SECOND_NS
from actum_model_trainer.augmentation import Variant, augmentation_for, varied
from actum_model_trainer.continuous.detections import Stretch, Truth
from actum_model_trainer.continuous.scoring import background_min
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.heads_training import FoldedHeads, fit_heads
from actum_model_trainer.spotting.threshold_choice import ScannedStream, chosen_threshold, logistic_fit
from actum_model_trainer.spotting.training_windows import live_windows, training_windows, true_completeness
from som_classifier.presets import PyramidPreset, SpottingPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotting_model import SpottingMetadata, SpottingModel
from som_classifier.spotting.windows import FEWEST_FRAMES

SHORTEST_S = 0.2
"""Shortest window (s): a shorter movement is a twitch."""
MIN_LOG_DURATION_SD = 0.15
"""Of ln(duration / s): people's tempos differ by as much even where the training's do not."""
CHUNK = 256
"""Windows whose vectors are held at once."""


def with_spotting(
    model: PyramidModel, streams: Sequence[LabelledStream], preset: PyramidPreset, seed: int, progress: Progress
) -> PyramidModel:
    """Return the model with the search, trained on whole streams.

    It is returned as it is where no stream holds any of its actions, or all are too short between gaps to be searched.
    """
    search = preset.spotting
    usable = [stream for stream in streams if len(stream.stamps_ns) >= FEWEST_FRAMES]
    durations_s, log_means, log_sds = _durations(usable, model.labels, search)
    folds = _Folds(usable, search.folds)
    drawn = _drawn(model, usable, durations_s, preset, np.random.default_rng(seed), progress)
    if not any(each.completeness.any() for each in drawn):
        return model
    heads = _heads(drawn, usable, folds, search)
    metadata = SpottingMetadata(
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
        threshold=search.thresholds[0],
        probability=[1.0, 0.0],
        background_s=_background_s(streams),
    )
    scanned = _scanned(model, usable, heads, folds, metadata, progress)
    if not any(len(each.windows) for each in scanned):
        return model
    choice = chosen_threshold(scanned, SpottingModel(heads.all, metadata), model.labels, search.thresholds)
    learned = metadata.model_copy(update=asdict(choice) | {"probability": _probability(scanned, model.labels)})
    return replace(model, heads=heads.all, metadata=model.metadata.model_copy(update={"spotting": learned}))


class _Folds:
    """The folds of cross-validation: people, or thirds of each stream where there are fewer people than folds."""

    def __init__(self, streams: Sequence[LabelledStream], folds: int) -> None:
        self._people = sorted({stream.person for stream in streams})
        self._folds = folds

    def of(self, stream: LabelledStream, windows: Indices) -> Indices:
        """Return the fold of each window (n, 2) of a stream, (n,)."""
        if len(self._people) >= self._folds:
            return np.full(len(windows), self._people.index(stream.person) % self._folds)
        thirds: Indices = windows.sum(axis=1) * self._folds // (2 * len(stream.stamps_ns))
        return thirds


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


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Training windows of one stream.

    Attributes:
        frames: (n, 2), first and last frame of each.
        completeness: (n, actions).
        vectors: (n, inputs).
    """

    frames: Indices
    completeness: Array
    vectors: NDArray[np.float32]


def _drawn(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    durations_s: Array,
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> list[_Drawn]:
    """Draw the training windows of all streams, each in some versions of its stream: as measured, or augmented."""
    windows = [training_windows(stream, model.labels, durations_s, rng) for stream in streams]
    copies = preset.spotting.most_windows / max(sum(len(each.frames) for each in windows), 1)
    augmentation = augmentation_for([stream.person for stream in streams], preset)
    drawn = []
    for done, (stream, each) in enumerate(zip(streams, windows, strict=True)):
        progress("windows of streams", done, len(streams))
        variants = list(varied(Variant(stream.postures, stream.velocities), stream.depth_inferred, augmentation, rng))
        often = min(int(copies), len(variants)) + (rng.random(len(each.frames)) < copies % 1)
        kept = np.repeat(np.arange(len(each.frames)), np.minimum(often, len(variants)))
        of_window = rng.integers(len(variants), size=len(kept))
        vectors = np.zeros((len(kept), model.pyramid.cells * model.first.units), np.float32)
        for number in np.unique(of_window):
            encoded = EncodedStream(model, stream, variants[number])
            for n in np.flatnonzero(of_window == number):
                vectors[n] = encoded.vector(*each.frames[kept[n]].tolist())
        drawn.append(_Drawn(each.frames[kept], each.completeness[kept], vectors))
    progress("windows of streams", len(streams), len(streams))
    return drawn


def _heads(
    drawn: Sequence[_Drawn], streams: Sequence[LabelledStream], folds: _Folds, search: SpottingPreset
) -> FoldedHeads:
    of_fold = [folds.of(stream, each.frames) for stream, each in zip(streams, drawn, strict=True)]
    vectors = np.concatenate([each.vectors for each in drawn])
    completeness = np.concatenate([each.completeness for each in drawn])
    return fit_heads(vectors, completeness, np.concatenate(of_fold), search.folds, search.shrinkage)


def _scanned(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    heads: FoldedHeads,
    folds: _Folds,
    metadata: SpottingMetadata,
    progress: Progress,
) -> list[ScannedStream]:
    """Answer all live windows of the streams, each by heads that were trained without its fold."""
    durations_ns = np.rint(np.array(metadata.window_durations_s) * SECOND_NS).astype(np.int64)
    scanned = []
    for done, stream in enumerate(streams):
        progress("searching streams", done, len(streams))
        windows = live_windows(stream.stamps_ns, durations_ns, round(metadata.interval_s * SECOND_NS))
        scanned.append(ScannedStream(stream, windows, _answers(model, stream, windows, heads, folds)))
    progress("searching streams", len(streams), len(streams))
    return scanned


def _answers(
    model: PyramidModel, stream: LabelledStream, windows: Indices, heads: FoldedHeads, folds: _Folds
) -> NDArray[np.float32]:
    """Return the answers (n, actions) to windows (n, 2) of a stream by heads that were trained without their fold."""
    encoded, of_fold = EncodedStream(model, stream), folds.of(stream, windows)
    answers = np.zeros((len(windows), len(heads.all.offsets)), np.float32)
    for fold in np.unique(of_fold):
        in_fold = np.flatnonzero(of_fold == fold)
        for chunk in np.array_split(in_fold, -(-len(in_fold) // CHUNK)):
            vectors = np.stack([encoded.vector(first, last) for first, last in windows[chunk].tolist()])
            answers[chunk] = vectors @ heads.without[fold].axes + heads.without[fold].offsets
    return answers


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


def _background_s(streams: Sequence[LabelledStream]) -> float:
    """Return for how long people did none of the labelled actions (s)."""
    seen = [Stretch(each.file, each.agent, int(each.stamps_ns[0]), int(each.stamps_ns[-1])) for each in streams]
    truths = [Truth(each.file, each.agent, *segment) for each in streams for segment in each.segments]
    return 60 * background_min(seen, truths)
