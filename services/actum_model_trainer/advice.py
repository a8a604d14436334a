"""What to record next, in plain sentences, from what a set holds and how its models do on what they were not taught."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from actum_model_trainer.continuous.scoring import ContinuousScores
from actum_model_trainer.warnings import (
    CONFUSED_SHARE,
    CONFUSED_TIMES,
    ENOUGH_BACKGROUND_S,
    MIN_EXAMPLES,
    few,
    listed,
    unbalanced,
)

MORE_EXAMPLES = 3
"""Examples to record of each of two actions that are confused: of another person they tell much."""
MANY_FALSE_PER_MIN = 1.0
"""False alarms in a minute of which people complain."""
LOW_RECALL = 0.7
"""Share of an action's performances below which it is said that it is seldom found."""
FEWEST_DONE = 3
"""Performances of an action for that: of two a half may be chance."""


@dataclass(frozen=True)
class SetContents:
    """What a set holds: the number of examples by action, who is in it, background (s), examples that are doubted."""

    examples: Mapping[str, int]
    people: frozenset[str]
    background_s: float
    doubted: Mapping[str, int]


def advice(
    contents: SetContents, answers: Sequence[tuple[str, str]] = (), found: ContinuousScores | None = None
) -> list[str]:
    """Say what to record or mend next, the most urgent first.

    Args:
        contents: of the set.
        answers: action done and action answered, for each example left out in a cross-validation.
        found: what was found in whole takes left out.
    """
    return [
        *_too_few_actions(contents),
        *_doubted(contents),
        *_confused(contents, answers),
        *few(contents.examples),
        *unbalanced(contents.examples),
        *_one_person(contents),
        *_background(contents),
        *(_false_alarms(found) if found is not None else ()),
        *(_seldom_found(found) if found is not None else ()),
    ]


def _too_few_actions(contents: SetContents) -> Iterator[str]:
    if len(contents.examples) < 2:
        known = next(iter(contents.examples), None)
        yield (
            f"The set has examples of only one action, {known}: record at least one more action."
            if known
            else "The set has no examples yet: record at least two actions."
        )


def _doubted(contents: SetContents) -> Iterator[str]:
    if contents.doubted:
        named = listed(f"{n} of {label}" for label, n in sorted(contents.doubted.items()))
        yield f"Some examples may have a wrong start or end ({named}): check them, and trim or delete the wrong ones."


def _confused(contents: SetContents, answers: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Name each pair of actions that are taken for one another, the worst first."""
    times = Counter(answers)
    mistaken: Counter[tuple[str, str]] = Counter()
    for (done, answered), n in times.items():
        if done != answered:
            mistaken[min(done, answered), max(done, answered)] += n
    another = "another person" if len(contents.people) < 2 else "other people"
    for (a, b), wrong in sorted(mistaken.items(), key=lambda item: (-item[1], item[0])):
        tested = wrong + times[a, a] + times[b, b]
        if wrong >= CONFUSED_TIMES and wrong >= CONFUSED_SHARE * tested:
            yield (
                f"The model confuses {a} and {b} (in {wrong} of {tested} test examples): record {MORE_EXAMPLES} more "
                f"examples of each by {another}, or perform the two actions more differently."
            )


def _one_person(contents: SetContents) -> Iterator[str]:
    if len(contents.people) == 1:
        who = next(iter(contents.people)) or "one person, without a name"
        yield f"All examples are of {who}: record {MIN_EXAMPLES} examples of each action by a second person."


def _background(contents: SetContents) -> Iterator[str]:
    lacking_s = ENOUGH_BACKGROUND_S - contents.background_s
    if lacking_s > 0:
        yield (
            f"The set has only {contents.background_s:.0f} s of background, that is, of people who do none of the "
            f"actions: record at least {lacking_s:.0f} s more."
        )


def _false_alarms(found: ContinuousScores) -> Iterator[str]:
    if found.false_per_min is None or found.false_per_min <= MANY_FALSE_PER_MIN:
        return
    false = {label: score.detections - score.right for label, score in found.per_action.items()}
    worst = max(false, key=lambda label: false[label])
    yield (
        f"The test gave {found.false_per_min:.1f} false alarms a minute, most often {worst}: record more background "
        f"(people who do none of the actions) with movements that resemble {worst}."
    )


def _seldom_found(found: ContinuousScores) -> Iterator[str]:
    for label, score in found.per_action.items():
        if score.truths >= FEWEST_DONE and score.recall < LOW_RECALL:
            yield (
                f"The test found only {score.right} of {score.truths} performances of {label}: record more examples "
                f"of {label}, with a second of rest before and after each."
            )
