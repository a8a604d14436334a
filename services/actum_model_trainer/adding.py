"""Adding examples of new actions to a trained model, whose maps and calibration of the search stay.

What the layers above the maps learnt from is kept in the model as coordinates (`actum_model_trainer.kept`). The new
examples' coordinates are appended, and the same layers are fitted to both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.augmentation import augmentation_for, variants
from actum_model_trainer.basis import Basis
from actum_model_trainer.convolution_training import features_of
from actum_model_trainer.gathering import series_of
from actum_model_trainer.kept import KeptWindows, kept_arrays, kept_data, pooled_basis
from actum_model_trainer.layers_above import fitted_model
from actum_model_trainer.left_out_by_coordinates import with_what_was_left_out
from actum_model_trainer.pooling import PooledVectors, Pooling
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.spotting.adding_heads import with_added_heads
from actum_model_trainer.training_data import SampleMeasures, TrainingData
from som_classifier.model import Arrays
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_metadata import PyramidMetadata
from som_classifier.pyramid_model import PyramidModel

EPOCHS = 3
"""Most times that the neurons are shown all scores: of a training's ten times the last change little, and each takes a
tenth of a second."""
DIRECTIONS = 48
"""Directions that are added to those kept, for what new examples have beside the others."""


def add(
    model: PyramidModel,
    kept: Arrays,
    samples: Sequence[SegmentSample],
    streams: Sequence[LabelledStream],
    digest: str,
    preset: PyramidPreset,
    seed: int,
    progress: Progress,
) -> PyramidModel:
    """Return the model with more examples, of new actions or of known ones; its maps stay.

    Args:
        model: that was trained.
        kept: what its file keeps of its training.
        samples: the new examples.
        streams: in which they lie.
        digest: of the samples before and the new ones.
        preset: of the training.
        seed: of what is drawn.
        progress: of the fitting.

    Raises:
        TrainingError: there is no example.
        KeptError: nothing that fits the model is kept, of its maps' training or of its search's.
    """
    if not samples:
        raise TrainingError(
            "no example in the recordings can be added to the model, because none shows a usable skeleton: record the "
            "action again"
        )
    known, rng = model.metadata, np.random.default_rng(seed)
    as_known = replace(preset, levels=tuple(known.levels), overlap=known.overlap, epochs=min(preset.epochs, EPOCHS))
    before = kept_data(kept, model)
    windows = None if known.spotting is None else KeptWindows.of(kept, model)
    data = _joined(before, _Measured.of(model, before.measures, samples, as_known, rng))
    origin = _origin(known, data) | {"data_digest": digest, "updated_from": model.id}
    above = fitted_model(model.first, data, origin, as_known, rng, progress)
    added = with_what_was_left_out(above, model, before, as_known)
    added = replace(added, kept=kept_arrays(data), continuation=model.continuation)
    if windows is None:
        return added
    moved = windows.moved(pooled_basis(kept), pooled_basis(added.kept))
    return with_added_heads(model, added, moved, streams, as_known, rng, progress)


@dataclass(frozen=True, eq=False)
class _Measured:
    """New samples: their numbers, the pooled vectors of each stage, and the features of the last stage's vectors."""

    measures: SampleMeasures
    stages: Sequence[PooledVectors]
    features: NDArray[np.float32]

    @classmethod
    def of(
        cls,
        model: PyramidModel,
        before: SampleMeasures,
        samples: Sequence[SegmentSample],
        preset: PyramidPreset,
        rng: np.random.Generator,
    ) -> "_Measured":
        """Pool, convolve and measure samples, each in as many variants as those before."""
        mirrors, convolutions = model.metadata.mirrors, model.opinion.convolutions
        augmentation = augmentation_for([*before.people.tolist(), *(each.person for each in samples)], preset)
        augmented = [list(variants(sample, augmentation, mirrors, rng)) for sample in samples]
        pooling = Pooling(model.first, model.pyramid, mirrors)
        stages = pooling.vectors(samples, augmented, preset.stages, beside=len(before.labels))
        everything = len(before.labels) + len(samples)
        features = features_of(convolutions, series_of(samples, augmented, preset, everything))
        measures = SampleMeasures.of(samples, model.first, [of_sample[0].postures for of_sample in augmented])
        return cls(measures, stages, features)


def _joined(before: TrainingData, new: _Measured) -> TrainingData:
    """Append new samples, in bases in which these, too, are known well; the background stays."""
    assert before.pooled_basis is not None and before.convolved_basis is not None
    first, features = len(before.measures.labels), new.features / before.convolved.spread
    pooled = before.pooled_basis.extended(np.concatenate([stage.vectors for stage in new.stages]), DIRECTIONS)
    convolved = before.convolved_basis.extended(features, DIRECTIONS)
    taught = np.concatenate([_padded(before.convolved.taught, convolved), convolved.coordinates(features)])
    background = _padded(before.convolved.background, convolved)
    return TrainingData(
        before.measures + new.measures,
        [
            PooledVectors(
                np.concatenate([_padded(one.vectors, pooled), pooled.coordinates(other.vectors)]),
                np.concatenate([one.sample_indices, first + other.sample_indices]),
            )
            for one, other in zip(before.stages, new.stages, strict=True)
        ],
        _padded(before.background, pooled),
        before.background_digest,
        replace(before.convolved, taught=taught, background=background),
        pooled,
        convolved,
    )


def _padded(coordinates: NDArray[np.float32], basis: Basis) -> NDArray[np.float32]:
    """Return coordinates (n, fewer) in a basis that was extended: nothing is known of them in its new directions."""
    return np.pad(coordinates, ((0, 0), (0, basis.rank - coordinates.shape[1])))


def _origin(known: PyramidMetadata, data: TrainingData) -> dict[str, Any]:
    """Return the metadata that describe all samples."""
    return known.model_dump() | {
        "labels": data.labels,
        "persons": sorted({*known.persons, *filter(None, data.measures.people.tolist())}),
        "samples": len(data.measures.labels),
        "spotting": None,
    }
