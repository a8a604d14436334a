"""The temporal pyramid's vectors of every variant of every sample, as a live classifier would pool them."""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices
from actum_model_trainer.augmentation import Variant
from actum_model_trainer.basis import Basis
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.samples import SegmentSample
from som_classifier.first_layer import FirstMaps
from som_classifier.frame_activity import UM_PER_M
from som_classifier.pyramid import PrefixSums, Pyramid, running_sums


class PooledVectors(NamedTuple):
    """One vector for each variant and share of an action.

    Attributes:
        vectors: (n, inputs).
        sample_indices: (n,), the sample of each.
        variant_indices: (n,), which of its variants.
    """

    vectors: NDArray[np.float32]
    sample_indices: Indices
    variant_indices: Indices


MAX_VECTORS = 2_000  # per stage, beyond one of each sample: more make the discriminants hardly better
CHUNK = 256  # vectors that are reduced to coordinates at once
MIN_FRAMES = 3  # of a share of an action: with fewer the live classifier gives no answer either


class Pooling:
    """Pooling of samples over the cells of a pyramid, through the first layer.

    Attributes:
        first: the trained maps.
        mirrors: whether actions of the left arm are read as their mirror image.
        basis: in which vectors are given as coordinates; None where they are given whole.
    """

    def __init__(self, first: FirstMaps, pyramid: Pyramid, mirrors: bool, basis: Basis | None = None) -> None:
        self.first, self.mirrors, self.basis = first, mirrors, basis
        self._pyramid = pyramid

    def vectors(
        self,
        samples: Sequence[SegmentSample],
        variants: Sequence[Sequence[Variant]],
        stages: Sequence[Sequence[float]],
        beside: int = 0,
        progress: Progress = silent,
    ) -> list[PooledVectors]:
        """Return the vectors of each stage, evenly thinned out to about `MAX_VECTORS`, at least one of each sample.

        Args:
            samples: of the training.
            variants: those of each sample.
            stages: the shares of an action (0 to 1) that belong to each stage.
            beside: how many samples were pooled before, which count in the thinning out.
            progress: of the pooling.
        """
        rows = [Rows(self.basis) for _ in stages]
        of_row: list[list[tuple[int, int]]] = [[] for _ in stages]
        for index, (sample, of_sample) in enumerate(zip(samples, variants, strict=True)):
            progress("pooling of examples", index, len(samples))
            sums = _VariantSums(self, sample, of_sample)
            for stage, fractions in enumerate(stages):
                pairs = list(product(fractions, range(len(of_sample))))
                step = min(-(-(beside + len(samples)) * len(pairs) // MAX_VECTORS), len(pairs))
                for fraction, variant in pairs[index % step :: step]:
                    rows[stage].append(self._pyramid.vector(sums.until(variant, fraction)))
                    of_row[stage].append((index, variant))
        progress("pooling of examples", len(samples), len(samples))
        return [
            PooledVectors(vectors.stacked(), *np.array(indices).T)
            for vectors, indices in zip(rows, of_row, strict=True)
        ]

    def of_background(
        self, windows: Sequence[SegmentSample], variants: Sequence[Sequence[Variant]]
    ) -> NDArray[np.float32]:
        """Return the vectors (windows, inputs) of movement that nobody taught, each of its only variant."""
        if not windows:
            inputs = self._pyramid.cells * self.first.units if self.basis is None else self.basis.rank
            return np.zeros((0, inputs), np.float32)
        rows = Rows(self.basis)
        for window, of_window in zip(windows, variants, strict=True):
            rows.append(self._pyramid.vector(_VariantSums(self, window, of_window).until(0, 1.0)))
        return rows.stacked()


class Rows:
    """Collects vectors (inputs,), or their coordinates in a basis: then only a few vectors are held at once."""

    def __init__(self, basis: Basis | None) -> None:
        self._basis = basis
        self._vectors: list[NDArray[np.float32]] = []
        self._coordinates: list[NDArray[np.float32]] = []

    def append(self, vector: NDArray[np.float32]) -> None:
        """Add a vector."""
        self._vectors.append(vector)
        if self._basis is not None and len(self._vectors) == CHUNK:
            self._reduce(self._basis)

    def stacked(self) -> NDArray[np.float32]:
        """Return all, (n, inputs) or (n, rank)."""
        if self._basis is None:
            return np.stack(self._vectors)
        if self._vectors:
            self._reduce(self._basis)
        return np.concatenate(self._coordinates)

    def _reduce(self, basis: Basis) -> None:
        self._coordinates.append(basis.coordinates(np.stack(self._vectors)))
        self._vectors.clear()


class _VariantSums:
    """The prefix sums of one sample's variants and of their mirror images, each worked out once when first needed."""

    def __init__(self, pooling: Pooling, sample: SegmentSample, variants: Sequence[Variant]) -> None:
        self._first, self._variants = pooling.first, variants
        self._left_handed = [pooling.mirrors and hand == "left" for hand in sample.acting_hands]
        steps_um = np.rint(sample.motion.sum(axis=1) * UM_PER_M).astype(np.int64)
        self._travelled_um = np.concatenate([[0], np.cumsum(steps_um)])
        self._sums: dict[tuple[int, bool], PrefixSums] = {}

    def until(self, variant: int, fraction: float) -> PrefixSums:
        """Return the sums over the first share of a variant, as the live classifier would have them at that time.

        The classifier mirrors by the arm that has acted so far, the variant is mirrored by the arm of the whole sample.
        """
        total = len(self._left_handed)
        frames = min(total, max(MIN_FRAMES, round(fraction * total)))
        same_arm = self._left_handed[frames - 1] == self._left_handed[-1]
        if (variant, same_arm) not in self._sums:
            as_read = self._variants[variant]
            sums = summed_activities(self._first, as_read if same_arm else as_read.mirrored)
            self._sums[variant, same_arm] = PrefixSums(list(sums), self._travelled_um)
        return self._sums[variant, same_arm].between(0, frames)


def summed_activities(first: FirstMaps, variant: Variant) -> NDArray[np.uint32]:
    """Return the sums of the activity before each of a variant's n frames, and after the last, (n + 1, channels)."""
    return running_sums(first.activities(variant.postures, variant.velocities))
