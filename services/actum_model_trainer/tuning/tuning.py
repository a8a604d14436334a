"""Tuning: watches recordings with every sensitivity, picks settings, and verifies them by the classifier's own node."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from actum.recording import Recording
from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.matching import intersection_over_union, matched
from actum_model_trainer.continuous.scoring import ContinuousScores, scores_of
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.tuning.choosing import chosen, found_in_all, held_out
from actum_model_trainer.tuning.doubts import doubts
from actum_model_trainer.tuning.trials import tried
from actum_model_trainer.tuning.weighing import Weighed
from som_classifier.model import Model
from som_classifier.segmentation import Segmentation
from som_classifier.spotting.spotted import SpottingOptions

OTHERWISE = "the final run found other segments than the search did: this is a bug, please report it"
"""What is said where both do not agree; the scores are the classifier's."""


class NothingLabelledError(ValueError):
    """No labelled action is in the recordings; the text says what to do."""

    def __init__(self) -> None:
        super().__init__(
            "these recordings hold no labelled action, so nothing can be tuned on them: label them with 'actum label'"
        )


@dataclass(frozen=True)
class Outcome:
    """What some settings give.

    Attributes:
        options: the settings.
        scores: of all recordings.
        lost: by action, how many right answers of the model's own settings are lost.
    """

    options: SpottingOptions
    scores: ContinuousScores
    lost: Counter[str]


@dataclass(frozen=True)
class Tuned:
    """The settings that were picked, and what speaks for and against them.

    Attributes:
        outcomes: of each sensitivity, with the other settings that suit it.
        best: of the settings that were picked; the scores are those of the classifier's own node.
        untuned: the scores of the model's own settings.
        elsewhere: the scores of each recording with settings that were picked on the others; None of a single one.
        doubts: sentences.
    """

    outcomes: tuple[Outcome, ...]
    best: Outcome
    untuned: ContinuousScores
    elsewhere: ContinuousScores | None
    doubts: tuple[str, ...]


def tuned(
    model: Model, recordings: Sequence[Recording], most_per_min: float | None = None, progress: Progress = silent
) -> Tuned:
    """Pick the settings of the search that suit labelled continuous recordings best.

    Args:
        model: finds actions without marks.
        recordings: with marks, which are kept from the classifier.
        most_per_min: the false alarms a minute of background that are accepted; None for whatever is best.
        progress: is called with how far the tuning is.

    Raises:
        NoSpotterError: the model cannot find actions without marks.
        NothingLabelledError: no labelled action is in any recording.
        RecordingError: a file is damaged.
    """
    weighed = [Weighed(trial) for trial in tried(model, recordings, progress)]
    untuned = found_in_all(weighed, SpottingOptions())
    if not untuned.truths:
        raise NothingLabelledError
    choice = chosen(weighed, most_per_min)
    outcomes = tuple(_outcome(each.options, found_in_all(weighed, each.options), untuned) for each in choice.offers)
    options = choice.best.options
    verified = found_by(model, recordings, progress, Segmentation(options=options))
    best = _outcome(options, verified, untuned)
    agree = set(verified.detections) == set(found_in_all(weighed, options).detections)
    said = [*doubts(model, weighed, best.scores, most_per_min), *([] if agree else [OTHERWISE])]
    elsewhere = scores_of(held_out(weighed, most_per_min)) if len(weighed) > 1 else None
    return Tuned(outcomes, best, scores_of(untuned), elsewhere, tuple(said))


def _outcome(options: SpottingOptions, found: Found, untuned: Found) -> Outcome:
    answered_truths = [
        {match.truth for match in matched(each.detections, each.truths, intersection_over_union)}
        for each in (untuned, found)
    ]
    lost = Counter(truth.label for truth in answered_truths[0] - answered_truths[1])
    return Outcome(options, scores_of(found), lost)
