"""Warnings about weaknesses of training samples: what a model cannot learn from them, and what to record next."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import ceil

from actum_model_trainer.samples import SegmentSample

MIN_EXAMPLES = 5  # of an action: fewer say little of how its performances differ
MAX_RATIO = 3  # between the numbers of examples of two actions: beyond, the rarer one is hardly learnt
CONFUSED_SHARE = 0.25  # of the answers within a pair of actions that name the wrong one: guessing makes half
CONFUSED_TIMES = 2  # wrong answers within a pair: a single one may be chance
ENOUGH_BACKGROUND_S = 60.0  # of people who do none of the actions: with less, false alarms cannot be counted
BACKGROUND = ("idle", "background")  # labels of segments in which none of the actions is done


def warnings_of(
    samples: Sequence[SegmentSample], answers: Sequence[tuple[str, str]], background_s: float = 0.0
) -> list[str]:
    """Return a warning, one sentence or two, for each weakness of the training samples.

    Args:
        samples: of the training.
        answers: action done and action answered, for each example in a cross-validation.
        background_s: for how long the recordings show people who do none of the actions.
    """
    counts = Counter(sample.label for sample in samples)
    actions = {label: n for label, n in sorted(counts.items()) if label not in BACKGROUND}
    people = {sample.person for sample in samples}
    background = [] if background_s >= ENOUGH_BACKGROUND_S else _no_background(counts)
    return [*_one_person(people), *few(counts), *unbalanced(actions), *_confused(answers), *background]


def _one_person(people: set[str]) -> Iterator[str]:
    if people == {""}:
        yield (
            "No recording names a person, so the model cannot learn how people differ. Record at least two people, "
            "each with --person and a name."
        )
    elif len(people) == 1:
        who = min(people)
        yield (
            f"All examples are of one person, {who}, so the model cannot learn how people differ. Record a second "
            "person."
        )


def few(counts: Mapping[str, int]) -> Iterator[str]:
    """Warn of actions with few examples, from their number by action."""
    few = {label: n for label, n in sorted(counts.items()) if n < MIN_EXAMPLES}
    if few:
        named = listed(f"{label} has {n} ({MIN_EXAMPLES - n} more needed)" for label, n in few.items())
        yield f"Few examples: {named}. Record at least {MIN_EXAMPLES} examples of each action."


def unbalanced(actions: Mapping[str, int]) -> Iterator[str]:
    """Warn of actions that have many times fewer examples than another, from their number by action."""
    largest = max(actions, key=lambda label: actions[label], default="")
    rare = {label: n for label, n in actions.items() if MAX_RATIO * n < actions[largest]}
    if rare:
        named = listed(f"{label} ({n})" for label, n in rare.items())
        needed = ceil(actions[largest] / MAX_RATIO)
        more = listed(f"{needed - n} more of {label}" for label, n in rare.items())
        yield (
            f"Unbalanced examples: {largest} has {actions[largest]} examples, more than {MAX_RATIO} times as many as "
            f"{named}. Record {more}."
        )


def _confused(answers: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Warn of each pair of actions that are taken for one another, the worst first."""
    times = Counter(answers)
    pairs = {tuple(sorted(answer)) for answer in times if answer[0] != answer[1]}
    mistaken = {(a, b): times[a, b] + times[b, a] for a, b in pairs}
    for (a, b), wrong in sorted(mistaken.items(), key=lambda item: (-item[1], item[0])):
        if wrong >= CONFUSED_TIMES and wrong >= CONFUSED_SHARE * (wrong + times[a, a] + times[b, b]):
            yield _confused_pair(a, b, times)


def _confused_pair(a: str, b: str, times: Mapping[tuple[str, str], int]) -> str:
    mistaken = [(done, answer) for done, answer in ((a, b), (b, a)) if times[done, answer]]
    tested = {label: sum(n for (done, _), n in times.items() if done == label) for label in (a, b)}
    confusions = listed(
        f"{done} was taken for {other} in {times[done, other]} of {tested[done]}" for done, other in mistaken
    )
    more = " and ".join(f"{MIN_EXAMPLES} more examples of {done}" for done, _ in mistaken)
    return (
        f"The model confuses {a} and {b}: in a test on examples left out of the training, {confusions}. Record "
        f"{more}, also by new people. If that does not help, perform the actions more differently, or give both the "
        "same label."
    )


def _no_background(counts: Mapping[str, int]) -> Iterator[str]:
    if counts and not any(label in counts for label in BACKGROUND):
        yield (
            "The recordings contain less than a minute of background (people who do none of the actions), so the "
            "model cannot reliably reject other movements. Record background with 'actum record' without --label."
        )


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number with its noun: 1 example, 2 examples."""
    return f"{number} {one if number == 1 else several or f'{one}s'}"


def listed(parts: Iterator[str]) -> str:
    """Join one or more parts in words: a, b and c."""
    *others, last = parts
    return f"{', '.join(others)} and {last}" if others else last
