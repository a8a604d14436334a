"""What tuning found, as tables for the terminal."""

from collections import Counter
from collections.abc import Iterator

from rich.box import SIMPLE
from rich.console import Group
from rich.table import Table
from rich.text import Text

from actum_model_trainer.continuous.scoring import ContinuousScores
from actum_model_trainer.tuning.doubts import SURE, rate_bounds
from actum_model_trainer.tuning.tuning import Outcome, Tuned
from som_classifier.spotting.spotted import SpottingOptions

MOST_NAMED = 3
"""Lost actions that are named for each sensitivity; all are for the one that is picked."""


def tuning_report(result: Tuned, most_per_min: float | None, seconds: float) -> Group:
    """Lay out what each sensitivity gives, what was picked, and what it costs, given how long it took (s)."""
    scores = result.best.scores
    headline = f"{scores.event.truths} actions, {scores.background_min:.1f} min of background, {seconds:.1f} s"
    return Group(Text(headline), _offers(result), _per_action(result), *map(Text, _sentences(result, most_per_min)))


def _offers(result: Tuned) -> Table:
    table = Table(title="what each sensitivity gives, with the other settings that suit it", box=SIMPLE)
    for heading in ("wanted / min", "told", "right", "events F1", "false / min", "latency"):
        table.add_column(heading, justify="right")
    table.add_column("left out, pause, cooldowns", min_width=18, overflow="fold")
    table.add_column("lost", min_width=14, overflow="fold")
    for outcome in result.outcomes:
        picked = outcome.options == result.best.options
        table.add_row(*_cells(outcome), style="bold" if picked else None)
    return table


def _cells(outcome: Outcome) -> tuple[str | Text, ...]:
    options, scores = outcome.options, outcome.scores
    wanted = options.false_alarms_per_min
    return (
        "the model's" if wanted is None else f"{wanted:g}",
        str(scores.event.detections),
        str(scores.event.right),
        f"{scores.event.f1:.3f}",
        "-" if scores.false_per_min is None else f"{scores.false_per_min:.2f}",
        "-" if scores.latency_s is None else f"{scores.latency_s[0]:.2f} s",
        Text(_others(options) or "-"),
        Text(_listed(outcome.lost, MOST_NAMED) or "-"),
    )


def _others(options: SpottingOptions) -> str:
    """Say which settings but the sensitivity are not as they are by default."""
    said = [f"without {name}" for name in sorted(options.disabled)]
    said += [f"pause {options.shortest_pause_s:g} s"] if options.shortest_pause_s else []
    said += [f"{name} {seconds:g} s" for name, seconds in sorted(options.cooldown_s.items())]
    return ", ".join(said)


def _per_action(result: Tuned) -> Table:
    table = Table(title="what it changes, per action: as the model is → as picked", box=SIMPLE)
    table.add_column("action", overflow="fold")
    for heading in ("done", "right", "false", "lost"):
        table.add_column(heading, justify="right", no_wrap=True)
    before, after = result.untuned.per_action, result.best.scores.per_action
    for label in sorted(before | after):
        done = (before.get(label) or after[label]).truths
        right = [each[label].right if label in each else 0 for each in (before, after)]
        false = [each[label].detections - each[label].right if label in each else 0 for each in (before, after)]
        lost = str(result.best.lost[label] or "")
        table.add_row(Text(label), str(done), "{} → {}".format(*right), "{} → {}".format(*false), lost)
    return table


def _sentences(result: Tuned, most_per_min: float | None) -> Iterator[str]:
    """Yield what was picked and what it costs, in words."""
    scores, options = result.best.scores, result.best.options
    wanted = options.false_alarms_per_min
    sensitivity = "the model's own sensitivity" if wanted is None else f"sensitivity {wanted:g} false alarms a minute"
    yield f"picked: {', '.join(filter(None, [sensitivity, _others(options)]))}"
    yield f"as the model is: {_in_words(result.untuned)}"
    yield f"as picked:       {_in_words(scores)}"
    if result.elsewhere is not None:
        yield f"picked on all other recordings in turn: {_in_words(result.elsewhere)}"
    lost = _listed(result.best.lost)
    yield f"lost of what the model finds as it is: {lost or 'nothing'}"
    if scores.background_min:
        least, most = rate_bounds(scores.false_detections, scores.background_min)
        yield f"false alarms: {least:.2f} to {most:.2f} a minute with {SURE:.0%} probability"
    if most_per_min is not None and scores.false_per_min is not None and scores.false_per_min > most_per_min:
        yield f"no settings have as few as {most_per_min:g} false alarms a minute here: these have the fewest"


def _in_words(scores: ContinuousScores) -> str:
    rate = "" if scores.false_per_min is None else f", {scores.false_per_min:.2f} false a minute"
    return f"{scores.event.right} of {scores.event.truths} found, events F1 {scores.event.f1:.3f}{rate}"


def _listed(counts: Counter[str], most: int | None = None) -> str:
    """List actions and how often, the most frequent first, and at most so many of them."""
    named = [f"{label} {count}" for label, count in counts.most_common(most)]
    return ", ".join(named + (["…"] if len(named) < len(counts) else []))
