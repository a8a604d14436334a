"""An evaluation as tables for the terminal."""

from collections import Counter

from rich.box import SIMPLE
from rich.console import Group
from rich.table import Table
from rich.text import Text

from actum_model_trainer.evaluation import Evaluation, wilson_interval


def report(evaluation: Evaluation, seconds: float) -> Group:
    """Lay out the summary, the table of scores by action and that of confusions, given how long it took (s)."""
    return Group(summary(evaluation, seconds), per_class(evaluation), confusion(evaluation))


def summary(evaluation: Evaluation, seconds: float) -> Text:
    """State accuracy, calibration error and the number of answers that say unknown."""
    low, high = wilson_interval(evaluation.correct, evaluation.n)
    parts = [
        f"accuracy {evaluation.accuracy:.1%} ({evaluation.correct} of {evaluation.n}, "
        f"95 % interval {low:.1%} to {high:.1%})"
    ]
    if evaluation.calibration_error is not None:
        parts.append(f"confidence off by {evaluation.calibration_error:.3f} on average (ECE)")
    if decisions := evaluation.unknown_decisions:
        parts.append(f"{sum(decisions)} of {len(decisions)} answers told unknown")
    return Text(", ".join([*parts, f"{seconds:.1f} s"]))


def per_class(evaluation: Evaluation) -> Table:
    """Tabulate the scores of each action."""
    table = Table(title="per action")
    table.add_column("action", overflow="fold")
    for heading in ("tests", "recognised", "rejected", "accuracy", "confidence", "unknown"):
        table.add_column(heading, justify="right", no_wrap=True)
    for label, score in evaluation.per_class.items():
        counts = str(score.n), str(score.correct), str(score.rejected)
        accuracy = score.accuracy if score.n else None
        table.add_row(Text(label), *counts, *map(_percent, (accuracy, score.confidence, score.unknown)))
    return table


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{share:.1%}"


def confusion(evaluation: Evaluation) -> Table | Text:
    """Tabulate which action was taken for which other, the most frequent confusion first."""
    mistakes = Counter((wrong.label, wrong.predicted) for wrong in evaluation.predictions if not wrong.correct)
    if not mistakes:
        return Text("confusion: none")
    table = Table(title="confusion", box=SIMPLE)
    table.add_column("done", overflow="fold")
    table.add_column("answered", overflow="fold")
    table.add_column("times", justify="right", no_wrap=True)
    for (done, answered), times in sorted(mistakes.items(), key=lambda item: (-item[1], item[0][0], item[0][1] or "")):
        table.add_row(Text(done), Text("(rejected)" if answered is None else answered), str(times))
    return table
