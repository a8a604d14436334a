"""Training of the completeness heads on windows: ridge regression, once on all windows and once without each fold."""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.augmentation import Variant, augmentation_for, varied
from actum_model_trainer.products import solution
from actum_model_trainer.progress import Progress
from actum_model_trainer.ridge import DualForm
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.spotting.common_head import with_common
from actum_model_trainer.spotting.encoded_stream import EncodedStream
from actum_model_trainer.spotting.training_windows import TrainingWindows
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotting_model import CompletenessHeads


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

    def heads(self, left_out: Sequence[int | None], shrinkage: float) -> list[CompletenessHeads]:
        """Train the actions' heads and the common one without each of these folds; None leaves out none."""
        return fit_heads(self.vectors, with_common(self.completeness), self.folds, left_out, shrinkage)


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
    drawn = [_Drawn.of(*each, copies, augmentation, rng) for each in zip(streams, windows, strict=True)]
    ends = np.cumsum([len(each.frames) for each in drawn])
    vectors = np.empty((ends[-1], model.pyramid.cells * model.first.units), np.float32)

    def pool(number: int) -> None:
        drawn[number].pool(model, vectors[ends[number] - len(drawn[number].frames) : ends[number]])

    side_by_side(pool, range(len(drawn)), "windows of streams", progress)
    of_fold = [folds.of(each.stream, each.frames) for each in drawn]
    return WindowRows(vectors, np.concatenate([each.completeness for each in drawn]), np.concatenate(of_fold))


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Windows of a stream, each in one of the stream's variants.

    Attributes:
        stream: in which they lie.
        variants: of the stream.
        variant_of: (n,), rising, the variant of each window.
        frames: (n, 2), first and last frame of each.
        completeness: (n, actions), what the heads are to answer.
    """

    stream: LabelledStream
    variants: Sequence[Variant]
    variant_of: Indices
    frames: Indices
    completeness: Array

    @classmethod
    def of(
        cls,
        stream: LabelledStream,
        windows: TrainingWindows,
        copies: float,
        augmentation: PyramidPreset,
        rng: np.random.Generator,
    ) -> "_Drawn":
        """Draw so many copies of each window, on average, at most one of each variant."""
        variants = list(varied(Variant((stream.postures, stream.velocities)), stream.depth_inferred, augmentation, rng))
        often = int(copies) + (rng.random(len(windows.frames)) < copies % 1)
        kept = np.repeat(np.arange(len(windows.frames)), np.minimum(often, len(variants)))
        variant_of = rng.integers(len(variants), size=len(kept))
        kept = kept[np.argsort(variant_of, kind="stable")]
        return cls(stream, variants, np.sort(variant_of), windows.frames[kept], windows.completeness[kept])

    def pool(self, model: PyramidModel, out: NDArray[np.float32]) -> None:
        """Write the pyramid vectors (n, inputs) of the windows."""
        for number in np.unique(self.variant_of).tolist():
            own = slice(*np.searchsorted(self.variant_of, [number, number + 1]).tolist())
            encoded = EncodedStream(model, self.stream, self.frames[own], self.variants[number])
            encoded.pool(0, own.stop - own.start, out[own])


def fit_heads(
    vectors: NDArray[np.float32],
    completeness: Array,
    folds: Indices,
    left_out: Sequence[int | None],
    shrinkage: float,
) -> list[CompletenessHeads]:
    """Fit completeness = vectors * axes + offsets by least squares + penalty * ‖axes‖², without each of some folds.

    The axes are sought in the span of the vectors (`DualForm`), so that one matrix of n × n inner products serves all.

    Args:
        vectors: (n, inputs).
        completeness: (n, actions).
        folds: (n,).
        left_out: of the folds, which may hold no window or all of them; None leaves out none.
        shrinkage: relative penalty.
    """
    form, rows = DualForm.of(vectors, shrinkage), [np.flatnonzero(folds != fold) for fold in left_out]

    def of_rows(kept: Indices) -> CompletenessHeads:
        intercept = completeness[kept].mean(axis=0) if len(kept) else np.zeros(completeness.shape[1])
        dual = np.zeros(completeness.shape)
        inner = form.products if len(kept) == len(folds) else form.products[np.ix_(kept, kept)]
        dual[kept] = solution(inner, completeness[kept] - intercept)
        return CompletenessHeads(*form.fitted(dual, intercept))

    longest_first = sorted(range(len(rows)), key=lambda number: -len(rows[number]))
    fitted = side_by_side(of_rows, [rows[number] for number in longest_first])
    return [heads for _, heads in sorted(zip(longest_first, fitted, strict=True), key=itemgetter(0))]
