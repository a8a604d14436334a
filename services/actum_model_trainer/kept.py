"""What a model file keeps of its training, so that actions can be added: coordinates of what the layers learnt from.

The arrays' names begin with `som_classifier.model.KEPT`. A classifier does not read them, and they are no part of a
model's id.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum_model_trainer.basis import Basis
from actum_model_trainer.convolution_training import Convolved
from actum_model_trainer.pooling import PooledVectors
from actum_model_trainer.provenance import KeptError
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.training_data import SampleMeasures, TrainingData
from som_classifier.model import KEPT, Arrays
from som_classifier.pyramid_model import PyramidModel

RANK = 256
"""Directions that are kept: 94 to 98 % of the variance of pooled vectors lies in them."""
MOST_RANK = 2 * RANK
"""Most directions that are kept after additions, each of which appends some, or of a training on many samples."""
TRAIN_AGAIN = "train the model again with this version of actum, from recordings of all actions"
COARSE = np.float16
"""The precision of what is kept: its rounding is small beside the noise of a sensor."""


@dataclass(frozen=True, eq=False)
class KeptWindows:
    """What the heads of the search were trained on.

    Attributes:
        coordinates: (n, rank), of the windows' pooled vectors.
        completeness: (n, actions), what the heads are to answer.
        share: of the common head in each action's own.
        digest: of the streams without an action that the search learnt from.
    """

    coordinates: NDArray[np.float32]
    completeness: Array
    share: float
    digest: str

    @classmethod
    def of(cls, arrays: Arrays, model: PyramidModel) -> "KeptWindows":
        """Return what a model with a search keeps of the search's training.

        Raises:
            KeptError: it keeps nothing of that, or it is damaged.
        """
        if f"{KEPT}window_coordinates" not in arrays:
            raise KeptError(
                "no action can be added to this model, because its file lacks the training data for finding actions "
                f"without marks: {TRAIN_AGAIN}"
            )
        with _naming_damage():
            coordinates = arrays[f"{KEPT}window_coordinates"].astype(np.float32)
            completeness = arrays[f"{KEPT}window_completeness"].astype(np.float64)
            share, digest = float(arrays[f"{KEPT}window_share"]), str(arrays[f"{KEPT}window_digest"])
            _expect("window_coordinates", coordinates, (len(coordinates), pooled_basis(arrays).rank))
            _expect("window_completeness", completeness, (len(coordinates), len(model.labels)))
        return cls(coordinates, completeness, share, digest)

    def moved(self, before: Basis, to: Basis) -> "KeptWindows":
        """Return the windows with coordinates in another basis."""
        return replace(self, coordinates=before.moved(self.coordinates, to))

    def with_labels(self, before: Sequence[str], labels: Sequence[str]) -> "KeptWindows":
        """Return the windows of the actions `before` as windows of more actions, of which they hold nothing."""
        completeness = np.zeros((len(self.completeness), len(labels)))
        completeness[:, [labels.index(label) for label in before]] = self.completeness
        return replace(self, completeness=completeness)

    def and_also(self, coordinates: NDArray[np.float32], completeness: Array) -> "KeptWindows":
        """Append windows."""
        joined = np.concatenate([self.coordinates, coordinates]), np.concatenate([self.completeness, completeness])
        return KeptWindows(*joined, self.share, self.digest)

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays of a model file."""
        return {
            f"{KEPT}window_coordinates": _coarse(self.coordinates),
            f"{KEPT}window_completeness": self.completeness.astype(COARSE),
            f"{KEPT}window_share": np.array(self.share),
            f"{KEPT}window_digest": np.array(self.digest),
        }


def reduced(data: TrainingData) -> TrainingData:
    """Return training data with coordinates in the place of vectors."""
    if data.pooled_basis is not None:
        return data
    pooled_and_convolved = (
        [*(stage.vectors for stage in data.stages), data.background],
        [data.convolved.taught, data.convolved.background],
    )
    pooled, features = side_by_side(lambda parts: Basis.of_all(parts, RANK), pooled_and_convolved)
    return replace(
        data,
        stages=[stage._replace(vectors=pooled.coordinates(stage.vectors)) for stage in data.stages],
        background=pooled.coordinates(data.background),
        convolved=data.convolved.in_basis(features),
        pooled_basis=pooled,
        convolved_basis=features,
    )


def kept_arrays(data: TrainingData) -> dict[str, NDArray[Any]]:
    """Return the arrays that a model file keeps of training data."""
    of = reduced(data)
    assert of.pooled_basis is not None and of.convolved_basis is not None
    kept: dict[str, NDArray[Any]] = {
        **{name: getattr(of.measures, name) for name in (each.name for each in fields(SampleMeasures))},
        **_basis_arrays("pooled", of.pooled_basis),
        **_basis_arrays("convolved", of.convolved_basis),
        "background": _coarse(of.background),
        "background_digest": np.array(of.background_digest),
        "convolved_taught": _coarse(of.convolved.taught),
        "convolved_background": _coarse(of.convolved.background),
        "convolved_spread": of.convolved.spread,
    }
    for number, stage in enumerate(of.stages):
        kept[f"stage_{number}"] = _coarse(stage.vectors)
        kept[f"stage_{number}_samples"] = stage.sample_indices.astype(np.int32)
    return {KEPT + name: array for name, array in kept.items()}


def kept_data(arrays: Arrays, model: PyramidModel) -> TrainingData:
    """Return the training data that a model keeps.

    Raises:
        KeptError: it keeps none, or they are damaged or another model's.
    """
    if not arrays:
        raise KeptError(
            f"no action can be added to this model, because its file contains no training data: {TRAIN_AGAIN}"
        )
    with _naming_damage():
        data = _restored({name.removeprefix(KEPT): array for name, array in arrays.items()}, model)
        pooled, features = data.pooled_basis, data.convolved_basis
        assert pooled is not None and features is not None
        inputs = len(pooled.directions), len(features.directions)
        if data.labels != model.labels or inputs != (model.stages.axes.shape[1], len(model.opinion.axes)):
            raise KeptError(
                "the training data in the model file belongs to another model (other actions or other sizes): "
                f"{TRAIN_AGAIN}"
            )
        _expect_whole(data, pooled, features)
    return data


def _expect_whole(data: TrainingData, pooled: Basis, features: Basis) -> None:
    """Check that restored arrays fit one another.

    Raises:
        KeptError: one does not.
    """
    count, last = len(data.measures.labels), len(data.stages[-1].vectors)
    for name, array in vars(data.measures).items():
        _expect(name, array, (count, *array.shape[1:]))
    for number, (vectors, samples) in enumerate(data.stages):
        _expect(f"stage_{number}", vectors, (len(samples), pooled.rank))
        if np.setdiff1d(samples, np.arange(count)).size:
            raise KeptError(
                f"the model file is damaged (its array stage_{number}_samples refers to more samples than the {count} "
                f"in the file): {TRAIN_AGAIN}"
            )
    _expect("background", data.background, (len(data.background), pooled.rank))
    _expect("convolved_spread", data.convolved.spread, (len(features.directions),))
    _expect("convolved_taught", data.convolved.taught, (last, features.rank))
    _expect("convolved_background", data.convolved.background, (len(data.background), features.rank))


def _expect(name: str, array: NDArray[Any], expected: tuple[int, ...]) -> None:
    if array.shape != expected:
        raise KeptError(
            f"the model file is damaged (its array {name} has the shape {array.shape} instead of {expected}): "
            f"{TRAIN_AGAIN}"
        )


@contextmanager
def _naming_damage() -> Iterator[None]:
    """Raise a `KeptError` for arrays that are missing or do not fit."""
    try:
        yield
    except KeptError:
        raise
    except (KeyError, ValueError, IndexError, TypeError) as error:
        raise KeptError(f"the training data in the model file is damaged ({error}): {TRAIN_AGAIN}") from None


def _restored(kept: Mapping[str, NDArray[Any]], model: PyramidModel) -> TrainingData:
    stages = []
    for number in range(len(model.metadata.fractions)):
        samples = kept[f"stage_{number}_samples"].astype(np.intp)
        vectors = kept[f"stage_{number}"].astype(np.float32)
        stages.append(PooledVectors(vectors, samples))
    convolved = [kept[f"convolved_{name}"].astype(np.float32) for name in ("spread", "taught", "background")]
    return TrainingData(
        SampleMeasures(**{each.name: kept[each.name] for each in fields(SampleMeasures)}),
        stages,
        kept["background"].astype(np.float32),
        str(kept["background_digest"]),
        Convolved(model.opinion.convolutions, *convolved),
        _restored_basis("pooled", kept),
        _restored_basis("convolved", kept),
    )


def learnt_beside(arrays: Arrays) -> tuple[str, ...]:
    """Return digests of what a model learnt from beside its samples: background and counterexamples; the search's."""
    names = f"{KEPT}background_digest", f"{KEPT}window_digest"
    return tuple(str(arrays[name]) for name in names if name in arrays)


def pooled_basis(arrays: Arrays) -> Basis:
    """Return the basis in which a model keeps pooled vectors."""
    return _restored_basis("pooled", {name.removeprefix(KEPT): array for name, array in arrays.items()})


def _coarse(coordinates: NDArray[np.float32]) -> NDArray[np.float16]:
    """Round `MOST_RANK` coordinates; those of outliers that are too large become the largest that there are."""
    largest = float(np.finfo(COARSE).max)
    return np.clip(coordinates[:, :MOST_RANK], -largest, largest).astype(COARSE)


def _basis_arrays(name: str, basis: Basis) -> Arrays:
    return {f"{name}_mean": basis.mean, f"{name}_directions": basis.first(MOST_RANK).directions.astype(COARSE)}


def _restored_basis(name: str, kept: Mapping[str, NDArray[Any]]) -> Basis:
    return Basis(kept[f"{name}_mean"], kept[f"{name}_directions"].astype(np.float32))
