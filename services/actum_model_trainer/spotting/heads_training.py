"""Training of the completeness heads on windows: ridge regression, once on all windows and once without each fold."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.augmentation import Variant, augmentation_for, varied
from actum_model_trainer.progress import Progress
from actum_model_trainer.ridge import dual_form
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.spotting.common_head import with_common
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.training_windows import TrainingWindows
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotting_model import CompletenessHeads


class FoldedHeads:
    """Heads trained on the windows of all folds but one, and on all windows once these are asked for.

    Attributes:
        without: by the fold that was left out.
    """

    def __init__(self, fit: Callable[[int | None], CompletenessHeads], fold_count: int) -> None:
        self._fit = fit
        self.without = side_by_side(fit, range(fold_count))

    @cached_property
    def all(self) -> CompletenessHeads:
        """Return the heads trained on all windows."""
        return self._fit(None)


class Folds:
    """The folds of cross-validation: people, or parts of each stream where there are fewer people than folds.

    Args:
        streams: of the training.
        count: how many folds; some may hold no window.
    """

    def __init__(self, streams: Sequence[LabelledStream], count: int) -> None:
        self._people = sorted({stream.person for stream in streams})
        self.count = count

    def of(self, stream: LabelledStream, windows: Indices) -> Indices:
        """Return the fold of each window (n, 2; first and last frame) of a stream, (n,)."""
        if len(self._people) >= self.count:
            return np.full(len(windows), self._people.index(stream.person) % self.count)
        parts: Indices = windows.sum(axis=1) * self.count // (2 * len(stream.stamps_ns))
        return parts


class WindowRows(NamedTuple):
    """Windows as the heads are trained on them.

    Attributes:
        vectors: (n, inputs), pooled.
        completeness: (n, actions), what the heads are to answer.
        folds: (n,).
    """

    vectors: NDArray[np.float32]
    completeness: Array
    folds: Indices

    def heads(self, fold_count: int, shrinkage: float) -> FoldedHeads:
        """Train the actions' heads and the common one."""
        return fit_heads(self.vectors, with_common(self.completeness), self.folds, fold_count, shrinkage)


def window_rows(
    model: PyramidModel,
    streams: Sequence[LabelledStream],
    windows: Sequence[TrainingWindows],
    folds: Folds,
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> WindowRows:
    """Pool about `most_windows` of the streams' windows. Few windows are shown in several variants."""
    copies = preset.spotting.most_windows / max(sum(len(each.frames) for each in windows), 1)
    augmentation = augmentation_for([stream.person for stream in streams], preset)
    vectors, completeness, of_fold = [], [], []
    for done, (stream, each) in enumerate(zip(streams, windows, strict=True)):
        progress("windows of streams", done, len(streams))
        variants = list(varied(Variant((stream.postures, stream.velocities)), stream.depth_inferred, augmentation, rng))
        often = int(copies) + (rng.random(len(each.frames)) < copies % 1)
        kept = np.repeat(np.arange(len(each.frames)), np.minimum(often, len(variants)))
        drawn = rng.integers(len(variants), size=len(kept))
        vectors.append(_vectors(model, stream, variants, each.frames[kept], drawn))
        completeness.append(each.completeness[kept])
        of_fold.append(folds.of(stream, each.frames[kept]))
    progress("windows of streams", len(streams), len(streams))
    return WindowRows(np.concatenate(vectors), np.concatenate(completeness), np.concatenate(of_fold))


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


def fit_heads(
    vectors: NDArray[np.float32], completeness: Array, folds: Indices, fold_count: int, shrinkage: float
) -> FoldedHeads:
    """Fit completeness = vectors * axes + offsets by least squares + penalty * ‖axes‖².

    The axes are sought in the span of the vectors (`dual_form`), so that one matrix of n × n inner products serves all
    folds.

    Args:
        vectors: (n, inputs).
        completeness: (n, actions).
        folds: (n,), 0 to fold_count - 1.
        fold_count: how many there are; some may hold no window.
        shrinkage: relative penalty.
    """
    mean, centred, products, penalty = dual_form(vectors, shrinkage)
    products.ravel()[:: len(products) + 1] += penalty

    def without(fold: int | None) -> CompletenessHeads:
        kept = np.flatnonzero(folds != fold)
        kept_mean = completeness[kept].mean(axis=0) if len(kept) else np.zeros(completeness.shape[1])
        dual = np.zeros(completeness.shape, np.float32)
        inner = products if fold is None else products[np.ix_(kept, kept)]
        dual[kept] = np.linalg.solve(inner, completeness[kept] - kept_mean)
        axes = centred.T @ dual
        return CompletenessHeads(axes, (kept_mean - mean @ axes).astype(np.float32))

    return FoldedHeads(without, fold_count)
