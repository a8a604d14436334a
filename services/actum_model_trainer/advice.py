"""What to record or correct next, in sentences: from the examples, and from how models do on what was left out."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil

from actum_model_trainer.continuous.scoring import ContinuousScores
from actum_model_trainer.samples import SegmentSample

MIN_EXAMPLES = 5
"""Examples of an action: fewer say little of how its performances differ."""
MAX_RATIO = 3
"""Ratio of the numbers of examples of two actions: above it, the rarer one is hardly learnt."""
CONFUSED_SHARE = 0.25
"""Share of wrong answers within a pair of actions from which the pair counts as confused: guessing makes half."""
CONFUSED_TIMES = 2
"""Wrong answers within a pair from which it counts as confused: a single one may be chance."""
ENOUGH_BACKGROUND_S = 60.0
"""Background (s): with less, false alarms cannot be counted."""
BACKGROUND = ("idle", "background")
"""Labels of segments in which none of the actions is done."""
MANY_FALSE_PER_MIN = 1.0
"""False alarms per minute about which people complain."""
LOW_RECALL = 0.7
"""Share of an action's performances below which it counts as seldom found."""
FEWEST_DONE = 3
"""Performances of an action for that: half of two may be chance."""


@dataclass(frozen=True)
class Contents:
    """What there is to learn from.

    Attributes:
        examples: their number, by action.
        people: who performs them; "" stands for people without a name.
        background_s: duration of the background (s), in which people do none of the actions.
        doubted: number of examples that may have a wrong start or end, by action.
    """

    examples: Mapping[str, int]
    people: frozenset[str]
    background_s: float
    doubted: Mapping[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, samples: Sequence[SegmentSample], background_s: float) -> "Contents":
        """Return the contents of samples; a segment that is labelled as background counts as enough of it."""
        counts = Counter(sample.label for sample in samples)
        labelled = sum(counts.pop(label, 0) for label in BACKGROUND)
        people = frozenset(sample.person for sample in samples)
        return cls(dict(sorted(counts.items())), people, ENOUGH_BACKGROUND_S if labelled else background_s)


def advice(
    contents: Contents, answers: Sequence[tuple[str, str]] = (), found: ContinuousScores | None = None
) -> list[str]:
    """Return sentences about what to record or correct next, the most urgent first.

    Args:
        contents: of the set or the recordings.
        answers: action done and action answered, for each example left out in a cross-validation.
        found: what was found in whole takes left out.
    """
    return [
        *_too_few_actions(contents),
        *_doubted(contents),
        *_confused(contents, answers),
        *_few(contents),
        *_unbalanced(contents),
        *_one_person(contents),
        *_background(contents),
        *(_false_alarms(found) if found is not None else ()),
        *(_seldom_found(found) if found is not None else ()),
    ]


def _too_few_actions(contents: Contents) -> Iterator[str]:
    if len(contents.examples) < 2:
        known = next(iter(contents.examples), None)
        yield (
            f"There are examples of only one action, {known}: record at least one more action."
            if known
            else "There are no examples yet: record at least two actions."
        )


def _doubted(contents: Contents) -> Iterator[str]:
    if contents.doubted:
        named = _listed(f"{n} of {label}" for label, n in sorted(contents.doubted.items()))
        yield (
            f"Some examples may have a wrong start or end ({named}): check these examples, and trim or delete those "
            "that are wrong."
        )


def _confused(contents: Contents, answers: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Name each pair of actions of which one is answered for the other, the worst first."""
    times = Counter(answers)
    pairs = {tuple(sorted(answer)) for answer in times if answer[0] != answer[1]}
    mistaken = {(a, b): times[a, b] + times[b, a] for a, b in pairs}
    others = "another person" if len(contents.people) < 2 else "other people"
    for (a, b), wrong in sorted(mistaken.items(), key=lambda item: (-item[1], item[0])):
        if wrong >= CONFUSED_TIMES and wrong >= CONFUSED_SHARE * (wrong + times[a, a] + times[b, b]):
            yield (
                f"The model confuses {a} and {b}: in a test on examples left out of the training, "
                f"{_mistakes(a, b, times)}. Record {MIN_EXAMPLES} more examples of each of the two actions, performed "
                f"by {others}, or make the two actions more different."
            )


def _mistakes(a: str, b: str, times: Mapping[tuple[str, str], int]) -> str:
    tested = {label: sum(n for (done, _), n in times.items() if done == label) for label in (a, b)}
    return _listed(
        f"{done} was taken for {answered} in {times[done, answered]} of {tested[done]}"
        for done, answered in ((a, b), (b, a))
        if times[done, answered]
    )


def _few(contents: Contents) -> Iterator[str]:
    few = {label: n for label, n in contents.examples.items() if n < MIN_EXAMPLES}
    if few:
        named = _listed(f"{label} has {n} ({MIN_EXAMPLES - n} more needed)" for label, n in few.items())
        yield f"Too few examples: {named}. Record at least {MIN_EXAMPLES} examples of each action."


def _unbalanced(contents: Contents) -> Iterator[str]:
    actions = contents.examples
    largest = max(actions, key=lambda label: actions[label], default="")
    rare = {label: n for label, n in actions.items() if MAX_RATIO * n < actions[largest]}
    if rare:
        named = _listed(f"{label} ({n})" for label, n in rare.items())
        needed = ceil(actions[largest] / MAX_RATIO)
        more = _listed(f"{needed - n} more of {label}" for label, n in rare.items())
        yield (
            f"Unbalanced examples: {largest} has {actions[largest]} examples, more than {MAX_RATIO} times as many as "
            f"{named}. Record {more}."
        )


def _one_person(contents: Contents) -> Iterator[str]:
    if contents.people == {""}:
        yield (
            "The examples do not name the people who perform them, so the model cannot learn how people differ: "
            "record at least two people, and give the name of each."
        )
    elif len(contents.people) == 1:
        who = next(iter(contents.people))
        yield (
            f"All examples show the same person, {who}: record {MIN_EXAMPLES} examples of each action, performed by a "
            "second person."
        )


def _background(contents: Contents) -> Iterator[str]:
    lacking_s = ENOUGH_BACKGROUND_S - contents.background_s
    if contents.examples and lacking_s > 0:
        yield (
            f"There are only {contents.background_s:.0f} s of background, that is, of people who do none of the "
            f"actions: record at least {lacking_s:.0f} s more."
        )


def _false_alarms(found: ContinuousScores) -> Iterator[str]:
    if found.false_per_min is None or found.false_per_min <= MANY_FALSE_PER_MIN:
        return
    false = {label: score.detections - score.right for label, score in found.per_action.items()}
    worst = max(false, key=lambda label: false[label])
    yield (
        f"The test gave {found.false_per_min:.1f} false alarms a minute, most often of {worst}: record more "
        f"background (people who do none of the actions) with movements that resemble {worst}."
    )


def _seldom_found(found: ContinuousScores) -> Iterator[str]:
    for label, score in found.per_action.items():
        if score.truths >= FEWEST_DONE and score.recall < LOW_RECALL:
            yield (
                f"The test found only {score.right} of {score.truths} performances of {label}: record more examples "
                f"of {label}, with one second of rest before and after each example."
            )


def _listed(parts: Iterator[str]) -> str:
    """Join one or more parts in words: a, b and c."""
    *others, last = parts
    return f"{', '.join(others)} and {last}" if others else last
