"""What all parts share: the sets, and every recogniser trained once on the same sequences."""

from collections.abc import Sequence

from .datasets import Datasets, Example
from .ours import OURS, PAPERS, FittedMaps, Maps
from .peers import (
    DTW,
    MINIROCKET,
    MINIROCKET_UPRIGHT,
    MULTIROCKET,
    NEAREST,
    Fitted,
    FittedRocket,
    Recogniser,
    Rocket,
)
from .scores import Score
from .splits import Split

RECOGNISERS: tuple[Recogniser, ...] = (OURS, PAPERS, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, DTW, NEAREST)


class Bench:
    """The sets, and what has been trained on them."""

    def __init__(self, data: Datasets) -> None:
        self.data = data
        self._fitted: dict[tuple[Recogniser, tuple[Example, ...]], Fitted] = {}

    def maps(self, maps: Maps, examples: Sequence[Example]) -> FittedMaps:
        """Train a preset, or return what was trained."""
        fitted = self.fitted(maps, examples)
        assert isinstance(fitted, FittedMaps)
        return fitted

    def rocket(self, rocket: Rocket, examples: Sequence[Example]) -> FittedRocket:
        """Train kernels and ridge, or return what was trained."""
        fitted = self.fitted(rocket, examples)
        assert isinstance(fitted, FittedRocket)
        return fitted

    def fitted(self, recogniser: Recogniser, examples: Sequence[Example]) -> Fitted:
        """Train a recogniser, or return what was trained."""
        key = recogniser, tuple(examples)
        if key not in self._fitted:
            self._fitted[key] = recogniser.fit(examples)
        return self._fitted[key]

    def score(self, recogniser: Recogniser, split: Split, share: float = 1.0) -> Score:
        """Train, and count the right answers after a share of each test sequence."""
        return Score.of(self.fitted(recogniser, split.training).labels(split.test, share), split.test)
