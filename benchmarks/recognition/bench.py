"""What all parts share: the sets, and every recogniser trained once on the same sequences."""

from collections.abc import Sequence
from typing import Any

from .datasets import Datasets, Example
from .ours import OURS, PAPERS
from .peers import DTW, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, NEAREST, F_co, Recogniser, Trains
from .scores import Score
from .splits import Split

RECOGNISERS: tuple[Recogniser, ...] = (OURS, PAPERS, MINIROCKET, MINIROCKET_UPRIGHT, MULTIROCKET, DTW, NEAREST)


class Bench:
    """The sets, and what has been trained on them."""

    def __init__(self, data: Datasets) -> None:
        self.data = data
        self._fitted: dict[tuple[Recogniser, tuple[Example, ...]], Any] = {}

    def fitted(self, recogniser: Trains[F_co], examples: Sequence[Example]) -> F_co:
        """Train a recogniser, or return what was trained."""
        key = recogniser, tuple(examples)
        if key not in self._fitted:
            self._fitted[key] = recogniser.fit(examples)
        fitted: F_co = self._fitted[key]
        return fitted

    def score(self, recogniser: Recogniser, split: Split, share: float = 1.0) -> Score:
        """Train, and count the right answers after a share of each test sequence."""
        return Score.of(self.fitted(recogniser, split.training).labels(split.test, share), split.test)
