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
from actum_model_trainer.side_by_side import side_by_side
from som_classifier.first_layer import FirstMaps
from som_classifier.frame_activity import UM_PER_M
from som_classifier.pyramid import PrefixSums, Pyramid


class PooledVectors(NamedTuple):
    """One vector for each variant and share of an action.

    Attributes:
        vectors: (n, inputs).
        sample_indices: (n,), the sample of each.
    """

    vectors: NDArray[np.float32]
    sample_indices: Indices


MAX_VECTORS = 2_000  # per stage, beyond one of each sample: more make the discriminants hardly better
PART = 32  # samples that are pooled one after the other, beside others
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
        chosen = [chosen_of(variants, fractions, beside + len(samples)) for fractions in stages]
        ends = [np.cumsum([0, *map(len, of_stage)]) for of_stage in chosen]
        pooled = [self._room(of_stage[-1]) for of_stage in ends]

        def pool(part: range) -> None:
            bounds = [slice(of_stage[part.start], of_stage[part.stop]) for of_stage in ends]
            rows = [Rows(self.basis, self._inputs, out[own]) for out, own in zip(pooled, bounds, strict=True)]
            for index in part:
                sums = _VariantSums(self, samples[index], variants[index])
                for of_stage, own in zip(chosen, rows, strict=True):
                    for fraction, variant in of_stage[index]:
                        self._pool(sums.until(variant, fraction), own.room())
            for own in rows:
                own.finish()

        every = range(len(samples))
        side_by_side(pool, [every[start : start + PART] for start in every[::PART]], "pooling of examples", progress)
        return [
            PooledVectors(out, np.repeat(np.array(every), [len(each) for each in of_stage]))
            for out, of_stage in zip(pooled, chosen, strict=True)
        ]

    def of_background(
        self, windows: Sequence[SegmentSample], variants: Sequence[Sequence[Variant]]
    ) -> NDArray[np.float32]:
        """Return the vectors (windows, inputs) of movement that nobody taught, each of its only variant."""
        pooled = self._room(len(windows))
        rows = Rows(self.basis, self._inputs, pooled)
        for window, of_window in zip(windows, variants, strict=True):
            self._pool(_VariantSums(self, window, of_window).until(0, 1.0), rows.room())
        rows.finish()
        return pooled

    def _room(self, count: int) -> NDArray[np.float32]:
        """Return room for so many vectors, or for their coordinates."""
        return np.empty((count, self._inputs if self.basis is None else self.basis.rank), np.float32)

    @property
    def _inputs(self) -> int:
        return self._pyramid.cells * self.first.units

    def _pool(self, sums: PrefixSums, out: NDArray[np.float32]) -> None:
        self._pyramid.pool(sums, np.array([[0, len(sums)]]), out)


def chosen_of(
    variants: Sequence[Sequence[Variant]], fractions: Sequence[float], samples: int
) -> list[list[tuple[float, int]]]:
    """Return the shares and variants of each sample of which one stage has vectors, thinned out evenly."""
    chosen = []
    for index, of_sample in enumerate(variants):
        pairs = list(product(fractions, range(len(of_sample))))
        step = min(-(-samples * len(pairs) // MAX_VECTORS), len(pairs))
        chosen.append(pairs[index % step :: step])
    return chosen


class Rows:
    """Writes vectors, or their coordinates in a basis: then only a few vectors are held at once.

    Args:
        basis: of the coordinates; None where vectors are written whole.
        inputs: of a vector.
        out: (n, inputs) or (n, rank), where they are written.
    """

    def __init__(self, basis: Basis | None, inputs: int, out: NDArray[np.float32]) -> None:
        self._basis, self._out, self._written, self._reduced = basis, out, 0, 0
        self._vectors = out if basis is None else np.empty((min(len(out), CHUNK), inputs), np.float32)

    def room(self) -> NDArray[np.float32]:
        """Return the room for the next vector, (1, inputs)."""
        if self._written == len(self._vectors):
            self._reduce()
        self._written += 1
        return self._vectors[self._written - 1 : self._written]

    def finish(self) -> None:
        """Write what is left to be written."""
        if self._basis is not None:
            self._reduce()

    def _reduce(self) -> None:
        assert self._basis is not None
        after = self._reduced + self._written
        self._out[self._reduced : after] = self._basis.coordinates(self._vectors[: self._written])
        self._reduced, self._written = after, 0


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
            self._sums[variant, same_arm] = PrefixSums(sums, self._travelled_um)
        return self._sums[variant, same_arm].between(0, frames)


def summed_activities(first: FirstMaps, variant: Variant) -> NDArray[np.uint32]:
    """Return the sums of the activity before each of a variant's n frames, and after the last, (n + 1, channels)."""
    return first.running_sums(variant.postures, variant.velocities)
