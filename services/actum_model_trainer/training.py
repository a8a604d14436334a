"""Training of a model of the kind that the preset belongs to."""

from collections.abc import Sequence

from threadpoolctl import threadpool_limits

from actum_model_trainer import paper_training, pyramid_training
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import SegmentSample
from som_classifier.model import Model
from som_classifier.presets import PaperPreset, Preset

__all__ = ["TrainingError", "train"]


def train(samples: Sequence[SegmentSample], preset: Preset, seed: int = 0, progress: Progress = silent) -> Model:
    """Train a model; the same samples, preset and seed make the same model, to the bit on the same machine.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads of BLAS round differently from one
        if isinstance(preset, PaperPreset):
            return paper_training.train(samples, preset, seed, progress)
        return pyramid_training.train(samples, preset, seed, progress)
