"""How well a set teaches: each part of it is answered by a model that was trained on the rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from actum.recording import Recording
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import ContinuousScores, scores_of
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.evaluation import Evaluation, Prediction, prediction
from actum_model_trainer.progress import Progress, prefixed, silent
from actum_model_trainer.provenance import TrainingError, actions_of
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train_to_spot
from model_trainer.folds import folds_of
from som_classifier.presets import Preset
from som_classifier.spotting.spotted import SpottingOptions


@dataclass(frozen=True)
class SetEvaluation:
    """The results of a cross-validation.

    Attributes:
        by: what was left out in turn, `people` or `examples`.
        marked: the answers to the examples, each cut out as it was marked.
        found: the scores of what was found in whole takes without their marks; None where the preset's models find
            nothing.
    """

    by: str
    marked: Evaluation
    found: ContinuousScores | None

    def as_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        found = None if self.found is None else self.found.as_json()
        return {
            "by": self.by,
            "accuracy": self.marked.accuracy,
            "n": self.marked.n,
            "labels": self.marked.labels,
            "confusion": self.marked.confusion,
            "false_alarms_per_min": None if self.found is None else self.found.false_per_min,
            "found": found,
        }


def evaluate_set(recordings: Sequence[Recording], preset: Preset, progress: Progress = silent) -> SetEvaluation:
    """Leave each person out in turn, or else shares of the examples, and pool the answers.

    Raises:
        TrainingError: fewer than two actions, or so few examples that a part without them makes no model.
        RecordingError: a file is damaged.
    """
    samples = samples_from(recordings, progress)
    actions_of(samples.usable)
    by, folds = folds_of(samples)
    predictions: list[Prediction] = []
    found, finds = Found(), True
    for fold in folds:
        within = prefixed(f"{fold.name}: ", progress)
        rest = [sample for sample in samples.usable if not fold.holds_sample(sample)]
        _refuse_single_examples(samples.usable, rest)
        streams = [stream for stream in map(fold.without, samples.streams) if len(stream.stamps_ns)]
        model = train_to_spot(rest, streams, preset, progress=within)
        for sample in filter(fold.holds_sample, samples.usable):
            answered = answer(model, encoded(model, sample))
            predictions.append(prediction(sample.file, sample.segment_id, sample.label, answered.label, answered))
        finds = finds and model.spotter(SpottingOptions()) is not None
        if finds:
            held = [recording for recording in recordings if str(recording.path) in fold.spans]
            found += fold.within(found_by(model, held, within))
    return SetEvaluation(by, Evaluation(tuple(predictions)), scores_of(found) if finds else None)


def _refuse_single_examples(samples: Sequence[SegmentSample], rest: Sequence[SegmentSample]) -> None:
    """Refuse a test that would train on fewer than two actions, because a fold holds all examples of the others."""
    left = {sample.label for sample in rest}
    if len(left) < 2:
        lost = ", ".join(repr(label) for label in sorted({sample.label for sample in samples} - left))
        raise TrainingError(
            f"the test leaves out a third of the examples in turn, which can be all that there are of {lost}: record "
            "at least two examples of each action"
        )
