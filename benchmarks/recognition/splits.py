"""Who is trained on and who is tested."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .datasets import Example

SEED = 0
DRAWS = 10
TEST_SHARE = 0.25
LEFT_OUT = 3
FEW_DRAWS = 6
FEW_TESTED = 250
"""How many sequences a draw of few examples is tested on at most."""


@dataclass(frozen=True)
class Split:
    """Sequences to learn from and sequences to answer."""

    training: list[Example]
    test: list[Example]

    @property
    def people(self) -> str:
        """Who is trained on."""
        return ", ".join(str(person) for person in sorted({example.person for example in self.training}))


@dataclass(frozen=True)
class FewExamples:
    """Two people to learn from, in an order of their own and of their sequences, and others to answer.

    Attributes:
        people: the first of them is the one where there is only one.
        shown: their sequences, in the order in which they are given.
        test: sequences of everybody else.
    """

    people: tuple[int, int]
    shown: list[Example]
    test: list[Example]

    def training(self, people: int, count: int) -> list[Example]:
        """Return the first so many sequences of each action of the first or of both, or all where there are fewer."""
        given: Counter[tuple[int, str]] = Counter()
        chosen = []
        for example in self.shown:
            given[example.person, example.label] += 1
            if example.person in self.people[:people] and given[example.person, example.label] <= count:
                chosen.append(example)
        return chosen


def by_people(examples: Sequence[Example], training: set[int]) -> Split:
    return Split([e for e in examples if e.person in training], [e for e in examples if e.person not in training])


def odd_even(examples: Sequence[Example]) -> Split:
    """Train people 1, 3, 5, 7, 9 and test the others."""
    return by_people(examples, {1, 3, 5, 7, 9})


def halves(examples: Sequence[Example]) -> Iterator[Split]:
    """Draw five of ten people to train, again and again."""
    rng, people = np.random.default_rng(SEED), sorted({example.person for example in examples})
    for _ in range(DRAWS):
        yield by_people(examples, set(rng.permutation(people)[: len(people) // 2].tolist()))


def leave_one_person_out(examples: Sequence[Example]) -> Iterator[Split]:
    people = {example.person for example in examples}
    for person in sorted(people):
        yield by_people(examples, people - {person})


def same_people(examples: Sequence[Example]) -> Iterator[Split]:
    """Draw a quarter of the sequences to test, whoever did them, again and again."""
    rng, count = np.random.default_rng(SEED), round(TEST_SHARE * len(examples))
    for _ in range(DRAWS):
        order = rng.permutation(len(examples)).tolist()
        yield Split([examples[i] for i in order[count:]], [examples[i] for i in order[:count]])


def actions_left_out(split: Split) -> Iterator[tuple[list[str], Split]]:
    """Draw actions that the training does not see, again and again; name them, and give the test as it was."""
    rng, labels = np.random.default_rng(SEED), sorted({example.label for example in split.training})
    for _ in range(DRAWS):
        unknown = [labels[i] for i in sorted(rng.choice(len(labels), LEFT_OUT, replace=False).tolist())]
        yield unknown, Split([example for example in split.training if example.label not in unknown], split.test)


def few_examples(examples: Sequence[Example], of_few: Sequence[Example] | None = None) -> Iterator[FewExamples]:
    """Draw two people who did every action, again and again, everybody of them being first in turn.

    The sequences to learn from come from `of_few` where that holds more of them.
    """
    rng, more = np.random.default_rng(SEED), of_few or examples
    order = rng.permutation(complete_people(examples)).tolist()
    for number in range(FEW_DRAWS):
        people = order[number % len(order)], order[(number + 1) % len(order)]
        shown = [more[i] for i in rng.permutation(len(more)).tolist() if more[i].person in people]
        others = [example for example in examples if example.person not in people]
        tested = sorted(rng.permutation(len(others))[:FEW_TESTED].tolist())
        yield FewExamples(people, shown, [others[i] for i in tested])


def complete_people(examples: Sequence[Example]) -> list[int]:
    """Return the people of whom there is every action."""
    done: dict[int, set[str]] = defaultdict(set)
    for example in examples:
        done[example.person].add(example.label)
    labels = set().union(*done.values())
    return sorted(person for person, own in done.items() if own == labels)


def folds_of_people(examples: Sequence[Example], folds: int) -> Iterator[Split]:
    """Test the people in folds: of sorted people every so manieth, each time others."""
    people = sorted({example.person for example in examples})
    for fold in range(folds):
        yield by_people(examples, set(people) - set(people[fold::folds]))
