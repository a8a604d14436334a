"""How often a model is right on recordings, judged by the final answers of the live classifier's own node."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from math import sqrt
from typing import Any

from actum import keys
from actum.messages import Action, Segment
from actum.node import replay
from actum.recording import Recording
from model_trainer.progress import Progress, silent
from model_trainer.samples import classifier_input, samples_from, sensors
from model_trainer.training import TrainingError, train
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.presets import Preset

Z_95 = 1.959963984540054


@dataclass(frozen=True)
class Prediction:
    """A labelled segment and what it was taken for; `predicted` is None where it was rejected."""

    file: str
    segment_id: str
    label: str
    predicted: str | None

    @property
    def correct(self) -> bool:
        """Whether the answer is the label."""
        return self.predicted == self.label


@dataclass(frozen=True)
class ClassScore:
    """How one action fared."""

    n: int
    correct: int
    rejected: int
    accuracy: float


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
        """Each action's score; accuracy is the share of its own segments that were recognised."""
        scores = {}
        for label in self.labels:
            own = [prediction for prediction in self.predictions if prediction.label == label]
            correct = sum(prediction.correct for prediction in own)
            rejected = sum(prediction.predicted is None for prediction in own)
            scores[label] = ClassScore(len(own), correct, rejected, correct / len(own) if own else 0.0)
        return scores

    def as_json(self) -> dict[str, Any]:
        """Write everything as plain values."""
        return {
            "accuracy": self.accuracy,
            "n": self.n,
            "labels": self.labels,
            "confusion": self.confusion,
            "per_class": {label: asdict(score) for label, score in self.per_class.items()},
            "predictions": [asdict(prediction) for prediction in self.predictions],
        }


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


def leave_one_person_out(
    recordings: Sequence[Recording], preset: Preset, seed: int = 0, progress: Progress = silent
) -> Evaluation:
    """Test each person on a model trained on all others, and pool the predictions.

    Raises:
        TrainingError: fewer than two persons, or the others' samples make no model.
        RecordingError: a file is damaged.
    """
    people = sorted({recording.person for recording in recordings})
    if len(people) < 2:
        raise TrainingError(f"recordings of at least two persons are needed; these are of {people or 'none'}")
    samples = samples_from(recordings, progress).usable
    predictions: list[Prediction] = []
    for person in people:
        others = [sample for sample in samples if sample.person != person]
        model = train(others, preset, seed, _prefixed(f"without {person or 'unnamed'}: ", progress))
        own = [recording for recording in recordings if recording.person == person]
        predictions += evaluate(model, own, _prefixed(f"on {person or 'unnamed'}: ", progress)).predictions
    return Evaluation(tuple(predictions))


def _predictions(model: Model, recording: Recording, sensor: str) -> list[Prediction]:
    answers: dict[str, str | None] = {}
    for message in replay(SomClassifier(model), classifier_input(recording, sensor)):
        if isinstance(message, Action) and message.final:
            answers.setdefault(message.segment_id, message.action)
    return [
        Prediction(str(recording.path), segment_id, label, answers.get(segment_id))
        for segment_id, label in _labels(recording, sensor).items()
    ]


def _labels(recording: Recording, sensor: str) -> dict[str, str]:
    """Return the label of each labelled segment; the first start mark of an id counts."""
    labels: dict[str, str] = {}
    for mark in recording.messages((keys.SEGMENT,)):
        if isinstance(mark, Segment) and mark.sensor == sensor and mark.kind == "start" and mark.label is not None:
            labels.setdefault(mark.segment_id, mark.label)
    return labels


def _prefixed(prefix: str, progress: Progress) -> Progress:
    return lambda stage, done, total: progress(prefix + stage, done, total)
