"""The accuracy of a model on recordings, from the final answers of the node that also classifies live."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from math import sqrt
from typing import Any

from actum import keys
from actum.messages import Action, Segment, is_action
from actum.node import replay
from actum.recording import Recording
from actum_model_trainer.calibration_error import MIN_ANSWERS, calibration_error, confidence_bins
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import classifier_input, sensors
from som_classifier.model import Model, Recognition
from som_classifier.node import SomClassifier
from som_classifier.segmentation import Segmentation

Z_95 = 1.959963984540054  # standard deviations: the normal distribution holds 95 % within


@dataclass(frozen=True)
class Prediction:
    """A labelled segment and the answer to it.

    Attributes:
        predicted: the action answered; None where the segment was rejected.
        confidence: of the answer, 0 to 1; None where there is no answer or it comes without confidence.
        unknown: whether the answer says that it may be none of the trained actions (its familiarity, an open-set
            score, is below the threshold); None where the model gives no familiarity.
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
    """The results on the segments of one action.

    Attributes:
        n: number of segments.
        correct: number of right answers.
        rejected: number of segments without an answer.
        accuracy: correct / n, 0 where n is 0.
        confidence: the answers' mean confidence; None where no answer has one.
        unknown: the share of answers that say unknown; None where the model gives no familiarity.
    """

    n: int
    correct: int
    rejected: int
    accuracy: float
    confidence: float | None
    unknown: float | None


@dataclass(frozen=True)
class Evaluation:
    """The predictions of a test and the statistics over them. Rejected segments count as wrong."""

    predictions: tuple[Prediction, ...]

    @property
    def n(self) -> int:
        """The number of labelled segments, rejected ones included."""
        return len(self.predictions)

    @property
    def correct(self) -> int:
        """The number of right answers."""
        return sum(prediction.correct for prediction in self.predictions)

    @property
    def accuracy(self) -> float:
        """The share of right answers, 0 where there was no segment."""
        return self.correct / self.n if self.n else 0.0

    @cached_property
    def labels(self) -> list[str]:
        """Every action that was done or answered, sorted."""
        done = {prediction.label for prediction in self.predictions}
        return sorted(done | {p.predicted for p in self.predictions if p.predicted is not None})

    @cached_property
    def confusion(self) -> list[list[int]]:
        """The confusion matrix: counts by action done (rows) and answered (columns), in the order of `labels`.

        Rejected segments are not counted.
        """
        counts = Counter((prediction.label, prediction.predicted) for prediction in self.predictions)
        return [[counts[done, answered] for answered in self.labels] for done in self.labels]

    @cached_property
    def per_class(self) -> dict[str, ClassScore]:
        """The score of each action's own segments, by label."""
        return {label: _score([p for p in self.predictions if p.label == label]) for label in self.labels}

    @cached_property
    def unknown_decisions(self) -> list[bool]:
        """The open-set decisions, of each answer that has one: whether it says unknown."""
        return [prediction.unknown for prediction in self.predictions if prediction.unknown is not None]

    @cached_property
    def calibration_error(self) -> float | None:
        """The expected calibration error (ECE); None where too few answers have a confidence."""
        answers = [(p.confidence, p.correct) for p in self.predictions if p.confidence is not None]
        if len(answers) < MIN_ANSWERS:
            return None
        confidences, correct = zip(*answers, strict=True)
        return calibration_error(confidence_bins(confidences, correct))

    def as_json(self) -> dict[str, Any]:
        """Return predictions and statistics as plain values for JSON."""
        return {
            "accuracy": self.accuracy,
            "n": self.n,
            "calibration_error": self.calibration_error,
            "labels": self.labels,
            "confusion": self.confusion,
            "per_class": {label: asdict(score) for label, score in self.per_class.items()},
            "predictions": [asdict(prediction) for prediction in self.predictions],
        }


def _score(predictions: Sequence[Prediction]) -> ClassScore:
    correct = sum(prediction.correct for prediction in predictions)
    return ClassScore(
        n=len(predictions),
        correct=correct,
        rejected=sum(prediction.predicted is None for prediction in predictions),
        accuracy=correct / len(predictions) if predictions else 0.0,
        confidence=_mean([prediction.confidence for prediction in predictions]),
        unknown=_mean([prediction.unknown for prediction in predictions]),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None


def wilson_interval(correct: int, n: int) -> tuple[float, float]:
    """Return the Wilson score interval (95 %) of correct / n; (0, 1) where n is 0."""
    if n == 0:
        return 0.0, 1.0
    share, z2 = correct / n, Z_95**2
    centre = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = Z_95 * sqrt(share * (1 - share) / n + z2 / (4 * n * n)) / (1 + z2 / n)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def evaluate(model: Model, recordings: Sequence[Recording], progress: Progress = silent) -> Evaluation:
    """Replay recordings frame by frame through preprocessor and classifier, and compare final answers with labels.

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
    file: str, segment_id: str, label: str, predicted: str | None, answer: Action | Recognition | None
) -> Prediction:
    """Make the prediction of a labelled segment from the answer to it; `predicted` is the action that it names."""
    if predicted is None or answer is None:
        return Prediction(file, segment_id, label, None)
    unknown = None if answer.familiarity is None else answer.unknown
    return Prediction(file, segment_id, label, predicted, answer.confidence, unknown)


def segment_labels(recording: Recording, sensor: str) -> dict[str, str]:
    """Return the action of each labelled segment by its id; of several start marks of one id the first counts."""
    labels: dict[str, str] = {}
    for mark in recording.messages((keys.SEGMENT,)):
        if isinstance(mark, Segment) and mark.sensor == sensor and mark.kind == "start" and is_action(mark.label):
            labels.setdefault(mark.segment_id, mark.label)
    return labels


def _predictions(model: Model, recording: Recording, sensor: str) -> Iterator[Prediction]:
    answers: dict[str, Action] = {}
    for message in replay(
        SomClassifier(model, segmentation=Segmentation("marks")), classifier_input(recording, sensor)
    ):
        if isinstance(message, Action) and message.final:
            answers.setdefault(message.segment_id, message)
    for segment_id, label in segment_labels(recording, sensor).items():
        answer = answers.get(segment_id)
        yield prediction(str(recording.path), segment_id, label, answer.action if answer else None, answer)
