"""The peers: convolution features with a ridge classifier, and nearest neighbours."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from aeon.distances import dtw_pairwise_distance
from aeon.transformations.collection.convolution_based import MiniRocket, MultiRocket
from numba.core.errors import NumbaTypeSafetyWarning
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from sklearn.linear_model import RidgeClassifierCV
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler

from .datasets import Example, interpolated
from .splits import SEED

Floats = NDArray[Any]
Distances = Callable[[Floats, Floats], Floats]

INSTANTS, DTW_INSTANTS, DTW_BAND = 32, 40, 8
SHORTEST_FRAMES = 3
PREFIXES = (0.2, 0.4, 0.6, 0.8, 1.0)


class Fitted(Protocol):
    """A trained recogniser of any kind."""

    def labels(self, examples: Sequence[Example], share: float = 1.0) -> list[str]:
        """Answer each sequence after a share of it."""
        ...


F_co = TypeVar("F_co", bound=Fitted, covariant=True)


class Trains(Protocol[F_co]):
    """Something to train."""

    @property
    def name(self) -> str: ...

    def fit(self, examples: Sequence[Example]) -> F_co: ...


Recogniser = Trains[Fitted]


def camera_axes(example: Example) -> Floats:
    return example.camera_m


def upright(example: Example) -> Floats:
    return example.sample.postures


def resampled(frames: Floats, share: float, instants: int) -> NDArray[np.float32]:
    """Interpolate the first frames (n, 15, 3) at equal steps, shape (45, instants); 0 for what was never seen."""
    known = frames[: min(len(frames), max(SHORTEST_FRAMES, round(share * len(frames))))].reshape(-1, 45)
    seen = np.nan_to_num(interpolated(known))
    at = np.linspace(0, len(seen) - 1, instants)
    before = np.minimum(at.astype(int), len(seen) - 2)
    after = (at - before)[:, None]
    between: Floats = (1 - after) * seen[before] + after * seen[before + 1]
    return between.T.astype(np.float32)


@dataclass(frozen=True)
class FittedRocket:
    """Kernels and a linear classifier."""

    kernels: Any
    ridge: Pipeline
    view: Callable[[Example], Floats]

    def labels(self, examples: Sequence[Example], share: float = 1.0) -> list[str]:
        return list(self.ridge.predict(self._features(examples, share)))

    def decisions(self, examples: Sequence[Example]) -> Floats:
        """Return the ridge's value for each action, (examples, actions)."""
        values: Floats = self.ridge.decision_function(self._features(examples, 1.0))
        return values

    def _features(self, examples: Sequence[Example], share: float) -> Floats:
        inputs = np.stack([resampled(self.view(example), share, INSTANTS) for example in examples])
        return np.asarray(self.kernels.transform(inputs))


@dataclass(frozen=True)
class Rocket:
    """MiniRocket or MultiRocket, trained on these shares of each sequence."""

    name: str
    kernels: type[Any]
    view: Callable[[Example], Floats]
    shares: tuple[float, ...] = (1.0,)

    def fit(self, examples: Sequence[Example]) -> FittedRocket:
        inputs = [resampled(self.view(example), share, INSTANTS) for share in self.shares for example in examples]
        kernels = self.kernels(random_state=SEED)
        features = np.asarray(kernels.fit_transform(np.stack(inputs)))
        ridge = make_pipeline(StandardScaler(with_mean=False), RidgeClassifierCV(alphas=np.logspace(-3, 3, 10)))
        ridge.fit(features, [example.label for example in examples] * len(self.shares))
        return FittedRocket(kernels, ridge, self.view)


@dataclass(frozen=True)
class FittedNearest:
    """The training sequences themselves."""

    known: Floats
    known_labels: list[str]
    recogniser: "Nearest"

    def labels(self, examples: Sequence[Example], share: float = 1.0) -> list[str]:
        distances = self.recogniser.distances(self.recogniser.inputs(examples, share), self.known)
        return [self.known_labels[i] for i in distances.argmin(axis=1)]


@dataclass(frozen=True)
class Nearest:
    """The label of the nearest training sequence."""

    name: str
    instants: int
    distances: Distances

    def inputs(self, examples: Sequence[Example], share: float = 1.0) -> Floats:
        return np.stack([resampled(example.camera_m, share, self.instants) for example in examples]).astype(np.float64)

    def fit(self, examples: Sequence[Example]) -> FittedNearest:
        return FittedNearest(self.inputs(examples), [example.label for example in examples], self)


def warped(asked: Floats, known: Floats) -> Floats:
    """Return the distances of dynamic time warping within the band, all components warped alike."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NumbaTypeSafetyWarning)  # of aeon's own indices
        distances: Floats = dtw_pairwise_distance(asked, known, window=DTW_BAND / DTW_INSTANTS)
    return distances


def euclidean(asked: Floats, known: Floats) -> Floats:
    distances: Floats = cdist(asked.reshape(len(asked), -1), known.reshape(len(known), -1))
    return distances


MINIROCKET = Rocket("MiniRocket + ridge", MiniRocket, camera_axes)
MINIROCKET_UPRIGHT = Rocket("MiniRocket + ridge, our upright postures", MiniRocket, upright)
MINIROCKET_PREFIXES = Rocket("MiniRocket + ridge, trained on prefixes", MiniRocket, camera_axes, PREFIXES)
MINIROCKET_UPRIGHT_PREFIXES = Rocket(
    "MiniRocket + ridge, trained on prefixes of our upright postures", MiniRocket, upright, PREFIXES
)
MULTIROCKET = Rocket("MultiRocket + ridge", MultiRocket, camera_axes)
DTW = Nearest("DTW, 1-NN", DTW_INSTANTS, warped)
NEAREST = Nearest("Euclidean, 1-NN", INSTANTS, euclidean)
