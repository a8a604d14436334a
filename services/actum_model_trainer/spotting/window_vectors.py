"""Heads trained on windows of streams, each window as measured or augmented."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices
from actum_model_trainer.augmentation import Variant, augmentation_for, varied
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.common_head import with_common
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.heads_training import FoldedHeads, fit_heads
from actum_model_trainer.spotting.scanning import Folds
from actum_model_trainer.spotting.training_windows import TrainingWindows
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel


def trained_heads(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    windows: Sequence[TrainingWindows],
    folds: Folds,
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> FoldedHeads:
    """Train the actions' heads and the common one on about `most_windows` of the streams' windows.

    Few windows are shown in several variants.
    """
    copies = preset.spotting.most_windows / max(sum(len(each.frames) for each in windows), 1)
    augmentation = augmentation_for([stream.person for stream in streams], preset)
    vectors, completeness, of_fold = [], [], []
    for done, (stream, each) in enumerate(zip(streams, windows, strict=True)):
        progress("windows of streams", done, len(streams))
        variants = list(varied(Variant(stream.postures, stream.velocities), stream.depth_inferred, augmentation, rng))
        often = int(copies) + (rng.random(len(each.frames)) < copies % 1)
        kept = np.repeat(np.arange(len(each.frames)), np.minimum(often, len(variants)))
        vectors.append(
            _vectors(model, stream, variants, each.frames[kept], rng.integers(len(variants), size=len(kept)))
        )
        completeness.append(each.completeness[kept])
        of_fold.append(folds.of(stream, each.frames[kept]))
    progress("windows of streams", len(streams), len(streams))
    folded, shrinkage = np.concatenate(of_fold), preset.spotting.shrinkage
    targets = with_common(np.concatenate(completeness))
    return fit_heads(np.concatenate(vectors), targets, folded, folds.count, shrinkage)


def _vectors(
    model: PyramidModel, stream: LabelledStream, variants: Sequence[Variant], frames: Indices, variant_of: Indices
) -> NDArray[np.float32]:
    """Return the pyramid vectors (n, inputs) of windows (n, 2) in variants (n,) of a stream."""
    vectors = np.zeros((len(frames), model.pyramid.cells * model.first.units), np.float32)
    for number in np.unique(variant_of):
        encoded = EncodedStream(model, stream, variants[number])
        for n in np.flatnonzero(variant_of == number):
            vectors[n] = encoded.vector(*frames[n].tolist())
    return vectors
