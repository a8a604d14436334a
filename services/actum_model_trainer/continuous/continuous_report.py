"""The scores of what was found without marks, as tables for the terminal."""

from rich.box import SIMPLE
from rich.console import Group
from rich.table import Table
from rich.text import Text

from actum_model_trainer.continuous.scoring import ContinuousScores


def continuous_report(scores: ContinuousScores, seconds: float) -> Group:
    """Lay out the table of all scores and that of actions, given how long it took (s)."""
    event = scores.event
    headline = (
        f"{event.right} of {event.truths} actions found, {scores.false_detections} false detections in "
        f"{scores.background_min:.1f} min of background, {seconds:.1f} s"
    )
    return Group(Text(headline), overall(scores), per_action(scores))


def overall(scores: ContinuousScores) -> Table:
    """Tabulate the scores over all actions."""
    table = Table(title="found without marks", box=SIMPLE, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True)
    for name, value in _rows(scores):
        table.add_row(name, value)
    return table


def per_action(scores: ContinuousScores) -> Table:
    """Tabulate the scores of each action."""
    table = Table(title="per action")
    table.add_column("action", overflow="fold")
    for heading in ("done", "found", "right", "precision", "recall", "F1"):
        table.add_column(heading, justify="right", no_wrap=True)
    for label, score in scores.per_action.items():
        counts = str(score.truths), str(score.detections), str(score.right)
        table.add_row(Text(label), *counts, f"{score.precision:.1%}", f"{score.recall:.1%}", f"{score.f1:.1%}")
    return table


def _rows(scores: ContinuousScores) -> list[tuple[str, str]]:
    median_s, ninth_decile_s = scores.latency_s or (None, None)
    return [
        ("events F1", f"{scores.event.f1:.3f}"),
        ("precision, recall", f"{scores.event.precision:.3f}, {scores.event.recall:.3f}"),
        *((f"F1 at IoU {iou:g}", f"{value:.3f}") for iou, value in scores.f1_at_iou.items()),
        *([("action points F1 (±333 ms)", f"{scores.point_f1:.3f}")] if scores.point_f1 is not None else []),
        ("false detections / min of background", _number(scores.false_per_min, "{:.2f}")),
        ("of these in the background", _number(scores.alarms_per_min, "{:.2f}")),
        ("recall at 1 false detection / min", _number(scores.recall_at_rate, "{:.3f}")),
        ("latency after the true end, median", _number(median_s, "{:.2f} s")),
        ("latency after the true end, 90 %", _number(ninth_decile_s, "{:.2f} s")),
        ("fragmentations, merges", f"{scores.fragmentations}, {scores.merges}"),
    ]


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else form.format(value)
