"""How often a model is right on recordings, judged by the final answers of the live classifier's own node."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from math import sqrt
from typing import Any

from actum import keys
from actum.messages import Action, Segment
from actum.node import replay
from actum.recording import Recording
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.reliability import FEWEST, binned, calibration_error
from actum_model_trainer.samples import classifier_input, sensors
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.recognition import Recognition

Z_95 = 1.959963984540054


@dataclass(frozen=True)
class Prediction:
    """A labelled segment and what it was taken for.

    Attributes:
        predicted: None where it was rejected.
        confidence: None where there is no answer, or what answers tells none.
        unknown: whether it was told as possibly none of the trained actions; None where the model tells no familiarity.
    """

    file: str
    segment_id: str
    label: str
    predicted: str | None
    confidence: float | None = None
    unknown: bool | None = None

    @property
    def correct(self) -> bool:
        """Whether the answer is the label."""
        return self.predicted == self.label


@dataclass(frozen=True)
class ClassScore:
    """How one action fared.

    Attributes:
        accuracy: the share of its segments that were recognised.
        confidence: the mean over its answers; None where none tells any.
        unknown: the share of its answers that were told unknown; None where none tells.
    """

    n: int
    correct: int
    rejected: int
    accuracy: float
    confidence: float | None
    unknown: float | None


@dataclass(frozen=True)
class Evaluation:
    """The predictions of a test, and what follows from them. Rejected segments count as wrong."""

    predictions: tuple[Prediction, ...]

    @property
    def n(self) -> int:
        """How many labelled segments were answered."""
        return len(self.predictions)

    @property
    def correct(self) -> int:
        """How many of them rightly."""
        return sum(prediction.correct for prediction in self.predictions)

    @property
    def accuracy(self) -> float:
        """The share of right answers, 0 where there was nothing to answer."""
        return self.correct / self.n if self.n else 0.0

    @cached_property
    def labels(self) -> list[str]:
        """Every action that was done or answered, sorted."""
        done = {prediction.label for prediction in self.predictions}
        return sorted(done | {p.predicted for p in self.predictions if p.predicted is not None})

    @cached_property
    def confusion(self) -> list[list[int]]:
        """Counts by label done (rows) and answered (columns), in the order of `labels`; rejections in none."""
        counts = Counter((prediction.label, prediction.predicted) for prediction in self.predictions)
        return [[counts[done, answered] for answered in self.labels] for done in self.labels]

    @cached_property
    def per_class(self) -> dict[str, ClassScore]:
        """Each action's score, of its own segments."""
        return {label: _score([p for p in self.predictions if p.label == label]) for label in self.labels}

    @cached_property
    def told_unknown(self) -> list[bool]:
        """Whether it was told unknown, of each answer whose model can tell."""
        return [prediction.unknown for prediction in self.predictions if prediction.unknown is not None]

    @cached_property
    def calibration_error(self) -> float | None:
        """How far confidence is from accuracy on average (ECE); None where too few answers tell any."""
        sure = [(p.confidence, p.correct) for p in self.predictions if p.confidence is not None]
        if len(sure) < FEWEST:
            return None
        return calibration_error(binned([confidence for confidence, _ in sure], [correct for _, correct in sure]))

    def as_json(self) -> dict[str, Any]:
        """Write everything as plain values."""
        return {
            "accuracy": self.accuracy,
            "n": self.n,
            "calibration_error": self.calibration_error,
            "labels": self.labels,
            "confusion": self.confusion,
            "per_class": {label: asdict(score) for label, score in self.per_class.items()},
            "predictions": [asdict(prediction) for prediction in self.predictions],
        }


def _score(own: Sequence[Prediction]) -> ClassScore:
    correct = sum(prediction.correct for prediction in own)
    return ClassScore(
        n=len(own),
        correct=correct,
        rejected=sum(prediction.predicted is None for prediction in own),
        accuracy=correct / len(own) if own else 0.0,
        confidence=_mean([prediction.confidence for prediction in own]),
        unknown=_mean([prediction.unknown for prediction in own]),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    told = [value for value in values if value is not None]
    return sum(told) / len(told) if told else None


def wilson_interval(correct: int, n: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share; (0, 1) where n is 0."""
    if n == 0:
        return 0.0, 1.0
    share, z2 = correct / n, Z_95**2
    centre = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = Z_95 * sqrt(share * (1 - share) / n + z2 / (4 * n * n)) / (1 + z2 / n)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def evaluate(model: Model, recordings: Sequence[Recording], progress: Progress = silent) -> Evaluation:
    """Replay recordings frame by frame through preprocessor and classifier, and compare the final answers.

    Raises:
        RecordingError: a file is damaged.
    """
    predictions: list[Prediction] = []
    for done, recording in enumerate(recordings):
        progress("evaluating", done, len(recordings))
        for sensor in sensors(recording):
            predictions += _predictions(model, recording, sensor)
    progress("evaluating", len(recordings), len(recordings))
    return Evaluation(tuple(predictions))


def prediction(
    recording: Recording, segment_id: str, label: str, predicted: str | None, answer: Action | Recognition | None
) -> Prediction:
    """Set an answer, whichever way it was got, beside the label; `predicted` is the action that it names."""
    if predicted is None or answer is None:
        return Prediction(str(recording.path), segment_id, label, None)
    unknown = None if answer.familiarity is None else answer.unknown
    return Prediction(str(recording.path), segment_id, label, predicted, answer.confidence, unknown)


def labels_of(recording: Recording, sensor: str) -> dict[str, str]:
    """Return the label of each labelled segment; the first start mark of an id counts."""
    labels: dict[str, str] = {}
    for mark in recording.messages((keys.SEGMENT,)):
        if isinstance(mark, Segment) and mark.sensor == sensor and mark.kind == "start" and mark.label is not None:
            labels.setdefault(mark.segment_id, mark.label)
    return labels


def _predictions(model: Model, recording: Recording, sensor: str) -> Iterator[Prediction]:
    answers: dict[str, Action] = {}
    for message in replay(SomClassifier(model), classifier_input(recording, sensor)):
        if isinstance(message, Action) and message.final:
            answers.setdefault(message.segment_id, message)
    for segment_id, label in labels_of(recording, sensor).items():
        answer = answers.get(segment_id)
        yield prediction(recording, segment_id, label, answer.action if answer else None, answer)
