"""Every view of every sample, pooled as it would be read live at each share of its action."""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.augmentation import View
from actum_model_trainer.samples import SegmentSample
from som_classifier.first_layer import FirstMaps
from som_classifier.pyramid import Prefix, PrefixSums, Pyramid, quantised

Floats = NDArray[Any]
Indices = NDArray[np.intp]
Pooled = tuple[NDArray[np.float32], Indices]
"""One row per view and share of an action, and whose sample each row is."""

MOST_VECTORS = 2_000
"""So many rows tell enough of a stage; more are evenly thinned."""
SHORTEST_FRAMES = 3
_UM_PER_M = 1e6


class Pooling:
    """The first maps and the pyramid on them.

    Attributes:
        mirrors: whether what the left arm does is read in a mirror.
    """

    def __init__(self, first: FirstMaps, pyramid: Pyramid, mirrors: bool) -> None:
        self.first, self.mirrors = first, mirrors
        self._pyramid = pyramid

    def vectors(
        self, samples: Sequence[SegmentSample], shown: Sequence[Sequence[View]], stages: Sequence[Sequence[float]]
    ) -> list[Pooled]:
        """Return the pooled vectors of each stage, whose shares of the action are given, evenly thinned."""
        rows: list[list[Floats]] = [[] for _ in stages]
        owners: list[list[int]] = [[] for _ in stages]
        for owner, (sample, views) in enumerate(zip(samples, shown, strict=True)):
            trails = _Trails(self, sample, views)
            for number, fractions in enumerate(stages):
                each = len(views) * len(fractions)
                step = min(-(-len(samples) * each // MOST_VECTORS), each)
                for fraction, view in list(product(fractions, range(len(views))))[owner % step :: step]:
                    rows[number].append(self._pyramid.vector(trails.until(view, fraction)))
                    owners[number].append(owner)
        return [(np.stack(own), np.array(whose)) for own, whose in zip(rows, owners, strict=True)]


class _Trails:
    """One sample's views, each summed up once, as seen and in a mirror."""

    def __init__(self, pooling: Pooling, sample: SegmentSample, views: Sequence[View]) -> None:
        self._first, self._views = pooling.first, views
        self._left_handed = [pooling.mirrors and hand == "left" for hand in sample.acting_hands]
        steps_um = np.rint(sample.motion.sum(axis=1) * _UM_PER_M).astype(np.int64)
        self._travelled_um = [0, *np.cumsum(steps_um).tolist()]
        self._instants: dict[tuple[int, bool], list[Prefix]] = {}

    def until(self, view: int, fraction: float) -> PrefixSums:
        """Return a share of a view as it would be read live, when it is not known which arm will act."""
        total = len(self._left_handed)
        frames = min(total, max(SHORTEST_FRAMES, round(fraction * total)))
        as_whole = self._left_handed[frames - 1] == self._left_handed[-1]
        if (view, as_whole) not in self._instants:
            self._instants[view, as_whole] = self._summed(self._views[view] if as_whole else self._views[view].mirrored)
        return PrefixSums(self._instants[view, as_whole][: frames + 1])

    def _summed(self, view: View) -> list[Prefix]:
        activities = self._first.activities(view.postures, view.velocities)
        sums = np.zeros((len(activities) + 1, activities.shape[1]), np.uint32)
        np.cumsum(quantised(activities), axis=0, out=sums[1:])
        return [Prefix([own], so_far_um) for own, so_far_um in zip(sums, self._travelled_um, strict=True)]
