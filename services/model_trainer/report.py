"""An evaluation as tables for the terminal."""

from rich.box import SIMPLE
from rich.console import Group
from rich.table import Table
from rich.text import Text

from model_trainer.evaluation import Evaluation, wilson_interval


def report(evaluation: Evaluation, seconds: float) -> Group:
    """Lay out accuracy with its interval, the score of each action, and who was taken for whom."""
    return Group(summary(evaluation, seconds), per_class(evaluation), confusion(evaluation))


def summary(evaluation: Evaluation, seconds: float) -> Text:
    """Say in one line how often the answer was right."""
    low, high = wilson_interval(evaluation.correct, evaluation.n)
    return Text(
        f"accuracy {evaluation.accuracy:.1%} ({evaluation.correct} of {evaluation.n}, "
        f"95 % interval {low:.1%} to {high:.1%}), {seconds:.1f} s"
    )


def per_class(evaluation: Evaluation) -> Table:
    """Tabulate each action's tests, right answers and rejections."""
    table = Table("action", title="per action")
    for heading in ("tests", "recognised", "rejected", "accuracy"):
        table.add_column(heading, justify="right")
    for label, score in evaluation.per_class.items():
        accuracy = f"{score.accuracy:.1%}" if score.n else "-"
        table.add_row(Text(label), str(score.n), str(score.correct), str(score.rejected), accuracy)
    return table


def confusion(evaluation: Evaluation) -> Table:
    """Tabulate actions done (rows) against answered (columns, by the row's number; none: rejected)."""
    table = Table(title="confusion: rows done, columns answered", box=SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("", justify="right")
    table.add_column("action", no_wrap=True)
    for number in range(1, len(evaluation.labels) + 1):
        table.add_column(str(number), justify="right")
    table.add_column("none", justify="right", no_wrap=True)
    rows = zip(evaluation.labels, evaluation.confusion, evaluation.per_class.values(), strict=True)
    for number, (label, counts, score) in enumerate(rows, start=1):
        cells = [str(count) if count else "·" for count in counts]
        table.add_row(str(number), Text(label), *cells, str(score.rejected) if score.rejected else "·")
    return table
