"""How far a choice of settings or a test can be trusted: how sure its false alarms are, and what speaks against it."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from actum_model_trainer.continuous.scoring import FALSE_ALARMS_PER_MIN, ContinuousScores
from actum_model_trainer.tuning.weighing import Weighed
from som_classifier.model import Model

SURE = 0.95
"""Probability with which the true rate lies within the interval that is reported: the usual one."""
FEWEST_ACTIONS = 20
"""Done in the recordings: with fewer a single one moves the events F1 by more than settings do."""
BISECTIONS = 60
"""Of an interval for the mean of a count: to more than double precision."""


def rate_bounds(events: int, minutes: float) -> tuple[float, float]:
    """Return between which rates (1/min) the true one lies, `SURE` probably, where so many events were counted.

    The events are independent of each other, a Poisson process; the bounds are the exact ones (Garwood 1936).
    """
    tail = (1 - SURE) / 2
    least = _mean_where(1 - tail, events - 1) if events else 0.0
    return least / minutes, _mean_where(tail, events) / minutes


def doubts(
    model: Model, weighed: Sequence[Weighed], scores: ContinuousScores, most_per_min: float | None
) -> Iterator[str]:
    """Yield what speaks against trusting the scores of the settings that were chosen on these recordings."""
    yield from _of_people({each.trial.person for each in weighed}, model.metadata.persons)
    yield from _too_little(scores, FALSE_ALARMS_PER_MIN if most_per_min is None else most_per_min)
    if model.background_s == 0:
        yield (
            "the model was trained without background, so it has only one sensitivity and has to guess what is "
            "background: record background and train again"
        )
    yield from _of_actions((label for label, own in scores.per_action.items() if own.truths), model.labels)


def of_test(model: Model | None, people: Mapping[str, str], done: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield what makes the scores of a test better or worse than those of new people.

    Args:
        model: was tested; None where each person was with a model of all others.
        people: by file.
        done: actions, each with its file.
    """
    if model is None:
        yield from _of_people(people.values(), ())
        yield from _of_one_person((label, people[file]) for label, file in done)
    else:
        yield from _of_people(people.values(), model.metadata.persons)
        yield from _of_actions((label for label, _ in done), model.labels)


def _of_people(tested: Collection[str], trained: Collection[str]) -> Iterator[str]:
    """Yield where the people who are tested are, or may be, those whom the model was trained on."""
    if seen := sorted(set(tested) & set(trained) - {""}):
        yield (
            f"the model was trained on person {', '.join(seen)}, whom it recognises better than others: "
            "use recordings of somebody else"
        )
    if "" in tested:
        yield "a recording names no person: if the model was trained on that person, the result is too good"


def _of_actions(done: Iterable[str], known: Collection[str]) -> Iterator[str]:
    """Yield which of the actions that were done no model could recognise."""
    if unknown := sorted(set(done) - set(known)):
        yield f"the model does not know {', '.join(unknown)}, which the recordings contain: each one counts as missed"


def _of_one_person(done: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield which actions one person alone did, of actions and people: without that person, no model learns them."""
    people: dict[str, set[str]] = {}
    for label, person in done:
        people.setdefault(label, set()).add(person)
    if alone := sorted(label for label, of_label in people.items() if len(of_label) == 1):
        yield (
            f"only one person does {', '.join(alone)}, which the model that is tested on this person therefore does "
            "not know: each one counts as missed"
        )


def _too_little(scores: ContinuousScores, wanted_per_min: float) -> Iterator[str]:
    if scores.event.truths < FEWEST_ACTIONS:
        yield f"the recordings contain only {scores.event.truths} actions, too few to compare settings: record more"
    if not scores.background_min:
        yield "the recordings contain no background, so false alarms cannot be counted: record background activity"
        return
    least, most = rate_bounds(scores.false_detections, scores.background_min)
    if least <= wanted_per_min < most:
        yield (
            f"{scores.background_min:.1f} min of background are too short to tell whether there are more than "
            f"{wanted_per_min:g} false alarms a minute ({least:.2f} to {most:.2f}, {SURE:.0%} sure): record more"
        )


def _mean_where(probability: float, events: int) -> float:
    """Return the mean of the Poisson distribution which gives this probability to so many events or fewer."""
    low, high = 0.0, 10.0 + 3 * events
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        at_most = sum(math.exp(n * math.log(middle) - middle - math.lgamma(n + 1)) for n in range(events + 1))
        low, high = (middle, high) if at_most > probability else (low, middle)
    return (low + high) / 2
