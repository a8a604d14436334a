"""Training of a model of the kind that the preset belongs to."""

from collections.abc import Sequence

from threadpoolctl import threadpool_limits

from actum_model_trainer import paper_training, pyramid_training
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.spotting.spotting_training import with_spotting
from som_classifier.model import Model
from som_classifier.presets import PaperPreset, Preset
from som_classifier.pyramid_model import PyramidModel

__all__ = ["TrainingError", "train", "train_to_spot"]


def train(samples: Sequence[SegmentSample], preset: Preset, seed: int = 0, progress: Progress = silent) -> Model:
    """Train a model; the same samples, preset and seed make the same model, to the bit on the same machine.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads of BLAS round differently from one
        if isinstance(preset, PaperPreset):
            return paper_training.train(samples, preset, seed, progress)
        return pyramid_training.train(samples, preset, seed, progress)


def train_to_spot(
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    preset: Preset,
    seed: int = 0,
    progress: Progress = silent,
) -> Model:
    """Train a model that also finds actions without marks, where its preset can.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    model = train(samples, preset, seed, progress)
    if not isinstance(model, PyramidModel) or isinstance(preset, PaperPreset):
        return model
    with threadpool_limits(1, user_api="blas"):
        return with_spotting(model, streams, preset, seed, progress)
