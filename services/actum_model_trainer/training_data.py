"""What the layers above the first maps are trained on: numbers and vectors of samples, not the samples themselves."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.node import SECOND_NS
from actum_model_trainer.basis import Basis
from actum_model_trainer.confidence import log_errors_of
from actum_model_trainer.convolution_training import Convolved
from actum_model_trainer.discriminants import folds_of
from actum_model_trainer.pooling import PooledVectors
from actum_model_trainer.samples import SegmentSample
from som_classifier.body_movement import movements
from som_classifier.first_layer import FirstMaps

MIN_DURATION_S = 1 / 30  # one frame at 30 Hz: all stamps of a sample may be equal


@dataclass(frozen=True, eq=False)
class SampleMeasures:
    """Numbers of n samples.

    Attributes:
        labels: (n,), the action of each.
        people: (n,), who acts.
        depth_inferred: (n,), whether some distances were inferred from an image and a standard body's size.
        log_durations: (n,), ln(duration / s).
        log_errors: (n,), the mean log(d²) of the postures, d the distance (m) to the posture map.
        log_movements: (n, 2), the logarithm of how much legs and trunk move (m), NaN where a part is not seen.
        movements_m: (n,), how much everything moves.
    """

    labels: NDArray[np.str_]
    people: NDArray[np.str_]
    depth_inferred: NDArray[np.bool_]
    log_durations: Array
    log_errors: Array
    log_movements: Array
    movements_m: Array

    @classmethod
    def of(cls, samples: Sequence[SegmentSample], first: FirstMaps, measured: Sequence[Array]) -> "SampleMeasures":
        """Measure samples; `measured` are their postures as the classifier reads them."""
        moved = [movements(sample.stamps_ns, np.ascontiguousarray(sample.postures)) for sample in samples]
        return cls(
            np.array([sample.label for sample in samples]),
            np.array([sample.person for sample in samples]),
            np.array([sample.depth_inferred for sample in samples]),
            np.log([duration_s(sample) for sample in samples]),
            log_errors_of(first, measured),
            np.array([of_parts for of_parts, _ in moved]),
            np.array([moved_m for _, moved_m in moved]),
        )

    def __add__(self, more: "SampleMeasures") -> "SampleMeasures":
        """Append the numbers of other samples."""
        pairs = zip(vars(self).values(), vars(more).values(), strict=True)
        return SampleMeasures(*(np.concatenate(pair) for pair in pairs))

    @property
    def everybody(self) -> int:
        """The number of people."""
        return len(np.unique(self.people))

    @property
    def one_sample_each(self) -> bool:
        """Whether nobody has performed an action more than once."""
        return len(set(zip(self.people.tolist(), self.labels.tolist(), strict=True))) == len(self.labels)


@dataclass(frozen=True, eq=False)
class TrainingData:
    """All that the layers above the maps are trained on.

    Attributes:
        measures: of the samples.
        stages: the pooled vectors of each stage of an action.
        background: (m, inputs), pooled vectors of movement that nobody taught.
        background_digest: of the streams that this movement was drawn from.
        convolved: the features of the last stage's vectors and of the background.
        pooled_basis: in which the pooled vectors are coordinates; None where they are whole.
        convolved_basis: the same of the features.
    """

    measures: SampleMeasures
    stages: Sequence[PooledVectors]
    background: NDArray[np.float32]
    background_digest: str
    convolved: Convolved
    pooled_basis: Basis | None = None
    convolved_basis: Basis | None = None

    @cached_property
    def labels(self) -> list[str]:
        """The actions, sorted."""
        return sorted(set(self.measures.labels.tolist()))

    @cached_property
    def targets(self) -> Indices:
        """The action of each sample, as its number among the labels, (n,)."""
        return np.searchsorted(np.array(self.labels), self.measures.labels)

    @cached_property
    def folds(self) -> Indices:
        """The fold of each sample, (n,)."""
        return folds_of(self.measures.people.tolist(), self.measures.labels.tolist())


def duration_s(sample: SegmentSample) -> float:
    """Return how long a sample lasts, at least one frame."""
    return max(float(np.ptp(sample.stamps_ns)) / SECOND_NS, MIN_DURATION_S)
