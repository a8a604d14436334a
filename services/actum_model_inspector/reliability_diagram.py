"""The reliability diagram: accuracy over confidence."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.style import ACCENT, FAINT, INK, figure_with_layout, in_house_style
from actum_model_trainer.calibration_error import MIN_ANSWERS, ConfidenceBin, calibration_error, confidence_bins
from actum_model_trainer.evaluation import wilson_interval

WIDTH_IN = 6.8  # of the picture: about square axes


def labelled_answers(segments: Sequence[AnsweredSegment]) -> list[AnsweredSegment]:
    """Return the segments that have a label and an answer."""
    return [segment for segment in segments if segment.label is not None and segment.recognition is not None]


def bins(segments: Sequence[AnsweredSegment]) -> list[ConfidenceBin]:
    """Sort segments with an answer into bins by confidence; empty bins are left out."""
    answers = [(segment.recognition.confidence, segment.correct) for segment in segments if segment.recognition]
    return confidence_bins([confidence for confidence, _ in answers], [correct for _, correct in answers])


@in_house_style()
def reliability_picture(segments: Sequence[AnsweredSegment]) -> Figure:
    """Draw accuracy over confidence, and beneath it the number of answers of each point.

    Raises:
        ValueError: fewer than `MIN_ANSWERS` segments have a label and an answer.
    """
    known = labelled_answers(segments)
    if len(known) < MIN_ANSWERS:
        raise ValueError(
            f"the reliability diagram needs at least {MIN_ANSWERS} labelled segments in which the model recognised an "
            f"action, but there are only {len(known)}: give more recordings"
        )
    filled_bins = bins(known)
    figure = figure_with_layout(
        WIDTH_IN, 7.0, f"Confidence is {calibration_error(filled_bins):.2f} off on average ({len(known)} answers)"
    )
    upper, lower = figure.subplots(2, 1, height_ratios=[4, 1], sharex=True)
    _draw_accuracy(upper, filled_bins)
    lower.bar(
        [each.low + 0.05 for each in filled_bins], [each.n for each in filled_bins], 0.085, color=ACCENT, alpha=0.35
    )
    for each in filled_bins:
        lower.text(each.low + 0.05, each.n, str(each.n), ha="center", va="bottom", color=INK)
    lower.set(xlabel="confidence of the answer", ylabel="answers")
    lower.margins(y=0.25)
    return figure


def _draw_accuracy(axes: Axes, filled_bins: Sequence[ConfidenceBin]) -> None:
    axes.plot([0, 1], [0, 1], color=FAINT, linewidth=1, linestyle=(0, (4, 3)))
    axes.text(0.03, 0.95, "more often right than it says", color=FAINT, va="top")
    axes.text(0.98, 0.03, "less often right than it says", color=FAINT, ha="right")
    for each in filled_bins:
        axes.plot([each.confidence] * 2, wilson_interval(each.correct, each.n), color=ACCENT, linewidth=1.4)
    confidences, accuracies = [each.confidence for each in filled_bins], [each.accuracy for each in filled_bins]
    axes.plot(confidences, accuracies, color=ACCENT, linewidth=0.6)
    axes.scatter(
        confidences, accuracies, s=[30 + each.n for each in filled_bins], color=ACCENT, zorder=3, clip_on=False
    )
    axes.set(ylabel="share of right answers", xlim=(0, 1), ylim=(0, 1.02))
    reading = "on the dashed line, eight in ten of the answers given with 0.8 are right; bars: 95 % interval"
    axes.set_title(reading, wrap=True)
