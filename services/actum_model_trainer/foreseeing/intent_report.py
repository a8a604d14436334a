"""How well contacts are foreseen, as a table for the terminal."""

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Group
from rich.table import Table
from rich.text import Text

from actum_model_trainer.foreseeing.intent_scores import IntentScores
from actum_model_trainer.foreseeing.scoring import ALARM, BEFORE_S, HORIZON_S, PRECISION, Scores


def intent_report(scores: IntentScores, seconds: float) -> Group:
    """Lay out the summary and the table of actum and the baselines, given how long it took (s)."""
    return Group(*map(Text, summary(scores, seconds)), methods(scores))


def summary(scores: IntentScores, seconds: float) -> list[str]:
    """State what was tested, and what holds of actum alone."""
    return [
        f"{scores.contacts} contacts in {scores.minutes:.1f} min, labelled actions without a contact: "
        f"{scores.without_contact}, {seconds:.1f} s",
        f"{scores.false_alarms_per_min:.2f} false alarms a minute (probability of {ALARM} or more, and no contact "
        f"with that object within {HORIZON_S} s)",
        f"probability off by {scores.calibration_error:.3f} on average (ECE)",
    ]


def methods(scores: IntentScores) -> Table:
    """Tabulate the scores of actum and of each baseline."""
    table = Table(
        box=SIMPLE_HEAD,
        pad_edge=False,
        title="contacts foreseen",
        caption=(
            "ahead: median time over all contacts, 0 if not announced, at the earliest threshold at which "
            f"{PRECISION:.0%} of the announcements are right; announced: share of contacts announced ahead; right: "
            "share of contacts whose likeliest object is the right one so many seconds before; Brier score and error "
            "of the time to contact: 0.5 s before"
        ),
    )
    table.add_column("method", no_wrap=True)
    headings = "ahead", "precision", "announced", *(f"right {seconds}" for seconds in BEFORE_S)
    for heading in (*headings, "Brier", "time error"):
        table.add_column(heading, justify="right")
    for name, of_method in scores.methods.items():
        table.add_row(name, *_cells(of_method))
    return table


def _cells(scores: Scores) -> list[str]:
    ahead, half = scores.ahead, scores.at_half
    cells = [f"{ahead.median_s:.2f} s", f"{ahead.precision:.2f}", f"{ahead.recall:.2f}"]
    cells += [_number(each.right, "{:.2f}") for each in scores.before]
    if not scores.is_probable:
        return [*cells, "-", "-"]
    return [*cells, f"{half.brier:.2f}", f"{half.time_error_s:.2f} s"]


def _number(value: float, form: str) -> str:
    return "-" if np.isnan(value) else form.format(value)
