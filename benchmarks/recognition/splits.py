"""Who is trained on and who is tested."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .datasets import Example

SEED = 0
DRAWS = 10
TEST_SHARE = 0.25
LEFT_OUT = 3


@dataclass(frozen=True)
class Split:
    """Sequences to learn from and sequences to answer."""

    training: list[Example]
    test: list[Example]

    @property
    def people(self) -> str:
        """Who is trained on."""
        return ", ".join(str(person) for person in sorted({example.person for example in self.training}))


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
