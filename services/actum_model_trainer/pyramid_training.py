"""Training of the default recogniser: the first maps, and the layers above them."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Indices
from actum.som import Som
from actum_model_trainer.augmentation import Variant
from actum_model_trainer.gathering import Taught
from actum_model_trainer.hand_preference import people_prefer_one_hand
from actum_model_trainer.kept import KeptWindows, pooled_basis
from actum_model_trainer.layers_above import train_above
from actum_model_trainer.median_distances import median_quantization_error2
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import KeptError
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.side_by_side import side_by_side
from som_classifier.first_layer import MAP_INPUTS, FirstMaps, Inputs, frame_inputs
from som_classifier.model import NOTHING_KEPT, Arrays
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel

MAX_ROWS = 20_000  # per map of the first layer: some 60 for each of its 324 units
MOST_FRAMES = 400_000  # of variants that these rows are drawn from, about


def train(
    samples: Sequence[SegmentSample],
    background: Sequence[LabelledStream],
    preset: PyramidPreset,
    seed: int,
    progress: Progress,
) -> PyramidModel:
    """Train all layers; the same samples, background, preset and seed make the same model.

    Raises:
        TrainingError: fewer than two actions among the samples, or all samples move alike.
    """
    taught = Taught.of(samples, people_prefer_one_hand(samples), preset, seed)
    first = _first_maps(_some(taught), preset, taught.rng, progress)
    return train_above(first, taught, background, preset, seed, progress)


def update(
    model: PyramidModel,
    kept: Arrays,
    samples: Sequence[SegmentSample],
    background: Sequence[LabelledStream],
    preset: PyramidPreset,
    seed: int,
    progress: Progress,
) -> PyramidModel:
    """Train the layers above a model's maps anew, on samples of the same actions; its maps and its search stay.

    So it finds the same segments as before: only what they are called may change, and how like that they are. What the
    search reads is pooled as the model does, whatever the preset says. `kept` is what the model's file keeps of its
    training.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    known = model.metadata
    as_known = replace(preset, levels=tuple(known.levels), overlap=known.overlap)
    taught = Taught.of(samples, known.mirrors, as_known, seed)
    above = train_above(model.first, taught, background, as_known, seed, progress)
    metadata = above.metadata.model_copy(update={"spotting": known.spotting, "updated_from": model.id})
    kept_too = {**above.kept, **_moved(model, kept, above)}
    return replace(above, heads=model.heads, metadata=metadata, kept=kept_too, continuation=model.continuation)


def _moved(model: PyramidModel, kept: Arrays, above: PyramidModel) -> Arrays:
    """Return what is kept of the search's training, for a model whose layers above the maps are others.

    Without it, or where it is damaged, the model finds the same as before, but no action can be added to it.
    """
    try:
        return KeptWindows.of(kept, model).moved(pooled_basis(kept), pooled_basis(above.kept)).arrays
    except KeptError:
        return NOTHING_KEPT


def _some(taught: Taught) -> list[Sequence[Variant]]:
    """Return the variants of as many samples, spread evenly over the actions, as have about `MOST_FRAMES` frames."""
    frames = sum(len(of_sample) * len(of_sample[0].measured[0]) for of_sample in taught.augmented)
    return [taught.augmented[number] for number in taught.every(-(-frames // MOST_FRAMES))]


def _first_maps(
    augmented: Sequence[Sequence[Variant]], preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> FirstMaps:
    drawn = {name: _drawn(augmented, inputs, rng) for name, inputs in MAP_INPUTS.items()}
    numbers = np.unique(np.concatenate(list(drawn.values())))
    frames = _frames(list(chain(*augmented)), numbers)
    rows = {
        name: _training_rows(inputs.of(frames[np.searchsorted(numbers, drawn[name])]))
        for name, inputs in MAP_INPUTS.items()
    }

    def trained(name: str) -> tuple[Som, float]:
        som = Som.linear(*preset.units, rows[name]).train_batch(rows[name], preset.unit_epochs, preset.unit_radius)
        return som, preset.relative_contrast * median_quantization_error2(som, rows[name])

    each = side_by_side(trained, list(rows), "maps of the first layer", progress)
    maps = {name: som for name, (som, _) in zip(rows, each, strict=True)}
    contrasts = {name: contrast for name, (_, contrast) in zip(rows, each, strict=True)}
    return FirstMaps(maps, contrasts, preset.arm_shares)


def _drawn(augmented: Sequence[Sequence[Variant]], inputs: Inputs, rng: np.random.Generator) -> Indices:
    """Return the numbers of at most `MAX_ROWS` frames of all variants, drawn evenly of those with inputs of a map.

    A variant lacks what is missing in the sample as measured.
    """
    seen = [~np.isnan(inputs.of(frame_inputs(*of_sample[0].measured))).all(axis=1) for of_sample in augmented]
    known = np.flatnonzero(np.concatenate([np.tile(own, len(of)) for own, of in zip(seen, augmented, strict=True)]))
    return known if len(known) <= MAX_ROWS else known[rng.choice(len(known), MAX_ROWS, replace=False)]


def _frames(variants: Sequence[Variant], numbers: Indices) -> Floats:
    """Return the `frame_inputs` (n, 90) of some of all variants' frames, by their numbers (n,), which rise."""
    ends = np.cumsum([len(variant.measured[0]) for variant in variants])
    own = np.split(numbers, np.searchsorted(numbers, ends[:-1]))
    some = [
        variant.some(frames - end + len(variant.measured[0]))
        for variant, frames, end in zip(variants, own, ends.tolist(), strict=True)
    ]
    return np.concatenate([frame_inputs(variant.postures, variant.velocities) for variant in some])


def _training_rows(inputs: Floats) -> NDArray[np.float32]:
    """Return inputs (n, dim) as rows of float32, at least one.

    A component that is missing in all of them becomes 0: it is then the same for all units and decides nothing.
    """
    rows = inputs.astype(np.float32) if len(inputs) else np.zeros((1, inputs.shape[1]), np.float32)
    return np.where(np.isnan(rows).all(axis=0), np.float32(0), rows)
