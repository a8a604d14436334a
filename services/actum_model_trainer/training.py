"""Training of a model of the kind that the preset belongs to."""

from collections.abc import Callable, Sequence
from typing import Any

from threadpoolctl import threadpool_limits

from actum_model_trainer import paper_training, pyramid_training
from actum_model_trainer.background import counterexamples, shipped
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.provenance import TrainingError, actions_of
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.spotting.spotting_training import with_spotting
from som_classifier.model import Model
from som_classifier.presets import Preset

__all__ = ["SEARCHES", "TRAININGS", "UPDATES", "TrainingError", "train", "train_to_spot", "update"]


TRAININGS: dict[str, Callable[[Sequence[SegmentSample], Sequence[LabelledStream], Any, int, Progress], Model]] = {
    "paper": paper_training.train,
    "pyramid": pyramid_training.train,
}
"""The training of each kind of model on samples and background, with a preset of that kind and a seed."""
SEARCHES: dict[str, Callable[[Any, Sequence[LabelledStream], Any, int, Progress], Model]] = {"pyramid": with_spotting}
"""For each kind of model that finds actions without marks: adds the search to a trained model."""
UPDATES: dict[str, Callable[[Any, Sequence[SegmentSample], Sequence[LabelledStream], Any, int, Progress], Model]] = {
    "pyramid": pyramid_training.update
}
"""For each kind of model whose search can stay as it is: trains what names the segments found."""


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


def update(
    model: Model,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    preset: Preset,
    seed: int = 0,
    progress: Progress = silent,
) -> Model:
    """Train a model on samples that include corrections, so that it finds the same segments as before.

    A model of another kind than the preset's, of a kind that cannot be updated, of other actions or without a search is
    trained anew. The background is that which comes with actum.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    updating = UPDATES.get(preset.kind)
    alike = model.metadata.kind == preset.kind and model.labels == actions_of(samples)
    if updating is None or not alike or model.spotting is None:
        return train_to_spot(samples, streams, preset, seed, progress)
    with threadpool_limits(1, user_api="blas"):
        return updating(model, samples, [*shipped(), *counterexamples(streams)], preset, seed, progress)
