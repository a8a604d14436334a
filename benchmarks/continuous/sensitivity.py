"""Whether as many false alarms come as a user asks for."""

from collections.abc import Iterator, Sequence

from benchmarks.recognition.scores import table

from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import scores_of
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.segmentation import Segmentation
from som_classifier.spotting.spotted import SpottingOptions

from .bench import Bench, number, share
from .streams import Fold, folds, replayed

ASKED_PER_MIN = (None, 0.5, 1.0, 2.0, 4.0)


def sensitivity(bench: Bench) -> Iterator[str]:
    """The setting `false_alarms_per_min` beside the rate on new people."""
    people = folds(bench.data.utkinect, bench.data.utkinect)
    yield """UTKinect, the same models, watched with the setting `false_alarms_per_min` at several values; without it
the threshold holds that was chosen in training. Asked for is a rate of false detections among people left out of
training; given is the one on the test people."""
    header = ("asked for, a minute", "false / min (in background)", "actions found", "events F1", "F1@.5")
    yield table(header, (_row(bench, people, asked) for asked in ASKED_PER_MIN))


def classifier_at(model: Model, false_alarms_per_min: float | None) -> SomClassifier:
    """Return a classifier that is asked for a rate of false alarms; None for what the model was trained for."""
    return SomClassifier(model, segmentation=Segmentation(options=SpottingOptions(false_alarms_per_min)))


def asked_for(false_alarms_per_min: float | None) -> str:
    """Say which rate it is."""
    return "nothing" if false_alarms_per_min is None else f"{false_alarms_per_min:g}"


def _row(bench: Bench, people: Sequence[Fold], asked: float | None) -> list[str]:
    found = [
        replayed(classifier_at(bench.model_of(fold.training), asked), stream.recording)
        for fold in people
        for stream in fold.test
    ]
    scores = scores_of(sum(found, Found()))
    return [
        asked_for(asked),
        f"{number(scores.false_per_min)} ({number(scores.alarms_per_min)})",
        share(scores.event.recall),
        share(scores.event.f1),
        share(scores.f1_at_iou[0.5]),
    ]
