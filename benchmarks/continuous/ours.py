"""Our recogniser: finding actions by itself through the live nodes, and given the true segments."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from actum_model_trainer.answering import encoded
from actum_model_trainer.continuous.detections import Detection
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.training import train_to_spot
from som_classifier.model import Model
from som_classifier.presets import DEFAULT

from .methods import SEED
from .streams import Stream

ModelOf = Callable[[tuple[Stream, ...]], Model]


def trained(training: tuple[Stream, ...]) -> Model:
    """Train the default preset on streams."""
    samples = [sample for stream in training for sample in stream.taught.usable]
    return train_to_spot(samples, [each for stream in training for each in stream.taught.streams], DEFAULT, SEED)


class OncePerTraining:
    """Trains a model the first time it is asked for: all methods and parts share it."""

    def __init__(self, model_of: ModelOf = trained) -> None:
        self._model_of = model_of
        self._models: dict[tuple[Stream, ...], Model] = {}

    def __call__(self, training: tuple[Stream, ...]) -> Model:
        """Return the model of these streams."""
        if training not in self._models:
            self._models[training] = self._model_of(training)
        return self._models[training]


@dataclass(frozen=True, eq=False)
class FittedOurs:
    """A trained model."""

    model: Model

    def detections(self, stream: Stream) -> list[Detection]:
        """Replay the recording without its marks through preprocessor and classifier."""
        return list(found_by(self.model, [stream.recording]).detections)


@dataclass(frozen=True)
class Ours:
    """The default preset, which finds actions by itself."""

    model_of: ModelOf
    name: str = "actum"

    def fit(self, training: Sequence[Stream]) -> FittedOurs:
        return FittedOurs(self.model_of(tuple(training)))


@dataclass(frozen=True, eq=False)
class FittedBound:
    """A trained model that is given the true segments."""

    model: Model

    def detections(self, stream: Stream) -> list[Detection]:
        frames = encoded(self.model, stream.whole)
        detections = []
        for first, last in map(stream.frames_of, stream.truths):
            if last - first + 1 >= self.model.min_frames:
                answer = self.model.recognise(frames[first : last + 1], complete=True)
                detections.append(stream.detection(first, last, last, answer.label, answer.confidence))
        return detections


@dataclass(frozen=True)
class Bound:
    """The default preset on the true segments: what is left to gain."""

    model_of: ModelOf
    name: str = "true segments, then our classifier (bound)"

    def fit(self, training: Sequence[Stream]) -> FittedBound:
        return FittedBound(self.model_of(tuple(training)))
