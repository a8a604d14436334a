"""Training of a model of the kind that the preset belongs to."""

import hashlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from threadpoolctl import threadpool_limits

from actum.messages import NONE
from actum_model_trainer import adding, associative_training, continuation_regression, paper_training, pyramid_training
from actum_model_trainer.background import counterexamples, shipped
from actum_model_trainer.kept import learnt_beside
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.provenance import KeptError, TrainingError, actions_of, digest_of, digest_of_streams
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.spotting.spotting_training import digest_of_background, with_spotting
from som_classifier.model import NOTHING_KEPT, Arrays, Model
from som_classifier.presets import PRESETS, Preset

TRAININGS: dict[str, Callable[[Sequence[SegmentSample], Sequence[LabelledStream], Any, int, Progress], Model]] = {
    "paper": paper_training.train,
    "pyramid": pyramid_training.train,
}
"""The training of each kind of model on samples and background, with a preset of that kind and a seed."""
SEARCHES: dict[str, Callable[[Any, Sequence[LabelledStream], Any, int, Progress], Model]] = {"pyramid": with_spotting}
"""For each kind of model that finds actions without marks: adds the search to a trained model."""
UPDATES: dict[
    str, Callable[[Any, Arrays, Sequence[SegmentSample], Sequence[LabelledStream], Any, int, Progress], Model]
] = {"pyramid": pyramid_training.update}
"""For each kind of model whose search can stay as it is: trains what names the segments found."""
ADDITIONS: dict[
    str, Callable[[Any, Arrays, Sequence[SegmentSample], Sequence[LabelledStream], str, Any, int, Progress], Model]
] = {"pyramid": adding.add}
"""For each kind of model that examples can be added to: adds them, whatever was kept of the training."""
CONTINUATIONS: dict[str, Callable[[Any, Sequence[LabelledStream], int, Progress], Model]] = {
    "paper": associative_training.with_continuation,
    "pyramid": continuation_regression.with_continuation,
}
"""For each kind of model that can predict how a posture goes on: trains that on streams, with a seed."""


def train(
    samples: Sequence[SegmentSample],
    preset: Preset,
    seed: int = 0,
    progress: Progress = silent,
    background: Sequence[LabelledStream] | None = None,
) -> Model:
    """Train a model; the same arguments make the same model, to the bit on the same machine.

    `background` is movement that nobody taught: that which comes with actum (None), other streams, or none.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads of BLAS round differently from one
        return TRAININGS[preset.kind](samples, shipped() if background is None else background, preset, seed, progress)


def train_to_spot(
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    preset: Preset,
    seed: int = 0,
    progress: Progress = silent,
    background: Sequence[LabelledStream] | None = None,
) -> Model:
    """Train a model that also finds actions without marks, where its kind can.

    What is labelled as none of the actions in the streams counts as background, too.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    beside = [*(shipped() if background is None else background), *counterexamples(streams)]
    model, search = train(samples, preset, seed, progress, beside), SEARCHES.get(preset.kind)
    if search is None:
        return model
    with threadpool_limits(1, user_api="blas"):
        return search(model, streams, preset, seed, progress)


def with_continuation(
    model: Model, streams: Sequence[LabelledStream], seed: int = 0, progress: Progress = silent
) -> Model:
    """Return the model with a continuation that is trained on streams; all else stays as it is.

    Raises:
        TrainingError: the model's kind has no continuation, or no stream is long enough.
    """
    continuing = CONTINUATIONS.get(model.metadata.kind)
    if continuing is None:
        raise TrainingError(
            f"models of kind {model.metadata.kind!r} cannot predict later postures: train a model of preset "
            f"{' or '.join(PRESETS)}"
        )
    with threadpool_limits(1, user_api="blas"):
        return continuing(model, streams, seed, progress)


def update(
    model: Model,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    preset: Preset,
    seed: int = 0,
    progress: Progress = silent,
    kept: Arrays = NOTHING_KEPT,
) -> Model:
    """Train a model on samples that include corrections, so that it finds the same segments as before.

    Where nothing but examples of new actions has come since, these are added to the model; other background or
    counterexamples than those that the model learnt from count as something else. A model of another kind than
    the preset's, of a kind that cannot be updated, of other actions or without a search is trained anew. The background
    is that which comes with actum. `kept` is what the model's file keeps of its training; where it keeps nothing, or is
    damaged, nothing is added.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    if new := _added_since(model, kept, samples, streams, preset):
        holding = {sample.file for sample in new}
        more = [each for each in streams if each.file in holding]
        with suppress(KeptError):
            return _added(model, kept, new, more, digest_of(samples), seed, progress)
    updating = UPDATES.get(preset.kind)
    alike = model.metadata.kind == preset.kind and model.labels == actions_of(samples)
    if updating is None or not alike or model.spotting is None:
        return train_to_spot(samples, streams, preset, seed, progress)
    with threadpool_limits(1, user_api="blas"):
        return updating(model, kept, samples, [*shipped(), *counterexamples(streams)], preset, seed, progress)


def add_to(
    model: Model,
    kept: Arrays,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    seed: int = 0,
    progress: Progress = silent,
) -> Model:
    """Add examples of new actions, or more of known ones, to a model without training its maps anew.

    Args:
        model: that was trained.
        kept: what its file keeps of its training (`som_classifier.model_loading.kept_in`).
        samples: the examples to add.
        streams: in which they lie.
        seed: of what is drawn.
        progress: of the training.

    Raises:
        TrainingError: the model's kind cannot take examples, nothing is kept, there is no example, or something is
            labelled as none of the actions.
    """
    if of_none := counterexamples(streams):
        raise TrainingError(
            f"{of_none[0].file} contains segments with the label '{NONE}'. Such segments cannot be added to an "
            "existing model: train a new model from all recordings, or delete these segments"
        )
    digest = hashlib.sha256(f"{model.metadata.data_digest}{digest_of(samples)}".encode()).hexdigest()
    return _added(model, kept, samples, streams, digest, seed, progress)


def _added(
    model: Model,
    kept: Arrays,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    digest: str,
    seed: int,
    progress: Progress,
) -> Model:
    """Add examples; the digest is that of all samples, those before and these."""
    adding_to, preset = ADDITIONS.get(model.metadata.kind), PRESETS.get(model.metadata.preset)
    if adding_to is None or preset is None:
        raise TrainingError(
            f"no action can be added to a model of preset {model.metadata.preset}: train a new model from recordings "
            "of the old and the new actions"
        )
    with threadpool_limits(1, user_api="blas"):
        return adding_to(model, kept, samples, streams, digest, preset, seed, progress)


def _added_since(
    model: Model,
    kept: Arrays,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    preset: Preset,
) -> list[SegmentSample]:
    """Return the examples of new actions, where all else is as it was when the model was trained; else none.

    All else is the other examples, the background and the counterexamples.
    """
    before = [sample for sample in samples if sample.label in model.labels]
    new = [sample for sample in samples if sample.label not in model.labels]
    fits = model.spotting is not None and model.metadata.preset == preset.name and preset.kind in ADDITIONS
    if not fits or not new or digest_of(before) != model.metadata.data_digest:
        return []
    of_new = {sample.file for sample in new}
    background = digest_of_background([stream for stream in streams if stream.file not in of_new])
    beside = digest_of_streams([*shipped(), *counterexamples(streams)]), background
    return new if learnt_beside(kept) == beside else []
