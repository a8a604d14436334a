from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from benchmarks.recognition.datasets import Example, interpolated
from benchmarks.recognition.splits import FEW_DRAWS, FEW_TESTED, complete_people, few_examples, folds_of_people

from actum_model_trainer.samples import SegmentSample

pytestmark = pytest.mark.thorough

LABELS = ("bow", "kick", "wave")
PEOPLE = range(1, 9)
OF_EACH = 20


def example(person: int, label: str) -> Example:
    nothing = np.zeros((3, 15, 3))
    sample = SegmentSample(label, np.arange(3), nothing, nothing[..., 0, :], nothing, nothing, str(person), "", "")
    return Example(sample, nothing)


@pytest.fixture(scope="module")
def examples() -> list[Example]:
    """Eight people who did three actions twenty times; the eighth never kicked."""
    return [
        example(person, label)
        for person in PEOPLE
        for label in LABELS
        for _ in range(OF_EACH)
        if (person, label) != (8, "kick")
    ]


def counts(training: Sequence[Example]) -> Counter[tuple[int, str]]:
    return Counter((example.person, example.label) for example in training)


def test_nobody_who_lacks_an_action_is_learnt_from(examples: list[Example]) -> None:
    assert complete_people(examples) == [1, 2, 3, 4, 5, 6, 7]
    assert all(8 not in draw.people for draw in few_examples(examples))


def test_everybody_is_first_in_turn(examples: list[Example]) -> None:
    assert len({draw.people[0] for draw in few_examples(examples)}) == FEW_DRAWS


def test_each_action_is_given_so_many_times(examples: list[Example]) -> None:
    for draw in few_examples(examples):
        first, second = draw.people
        assert counts(draw.training(1, 3)) == {(first, label): 3 for label in LABELS}
        assert counts(draw.training(2, 3)) == {(person, label): 3 for person in (first, second) for label in LABELS}


def test_who_has_fewer_gives_what_there_is(examples: list[Example]) -> None:
    draw = next(few_examples(examples))
    assert counts(draw.training(1, OF_EACH + 1)) == {(draw.people[0], label): OF_EACH for label in LABELS}
    assert draw.training(1, OF_EACH + 1) == draw.training(1, OF_EACH)


def test_fewer_examples_and_fewer_people_are_among_more(examples: list[Example]) -> None:
    for draw in few_examples(examples):
        assert set(draw.training(1, 2)) < set(draw.training(1, 5)) < set(draw.training(2, 5)) < set(draw.shown)


def test_neither_of_the_two_is_tested(examples: list[Example]) -> None:
    for draw in few_examples(examples):
        assert len(draw.test) == FEW_TESTED
        assert len(set(draw.test)) == FEW_TESTED
        assert not {example.person for example in draw.test} & set(draw.people)


def test_what_is_drawn_is_always_the_same(examples: list[Example]) -> None:
    assert list(few_examples(examples)) == list(few_examples(examples))


def test_more_sequences_to_learn_from_are_never_tested(examples: list[Example]) -> None:
    more = [*examples, *(example(person, label) for person in PEOPLE for label in LABELS)]
    draws = list(few_examples(examples, more))
    assert [draw.people for draw in draws] == [draw.people for draw in few_examples(examples)]
    assert all(set(draw.test) <= set(examples) for draw in draws)
    assert len(draws[0].training(1, 50)) == (OF_EACH + 1) * len(LABELS)


def test_each_person_is_tested_in_one_fold(examples: list[Example]) -> None:
    splits = list(folds_of_people(examples, 4))
    tested = [person for split in splits for person in sorted({example.person for example in split.test})]
    assert sorted(tested) == list(PEOPLE)
    assert [len(split.training) + len(split.test) for split in splits] == [len(examples)] * 4
    assert all({e.person for e in split.training}.isdisjoint({e.person for e in split.test}) for split in splits)


def test_what_is_missing_lies_between_its_neighbours() -> None:
    nan = float("nan")
    rows = np.array([[nan, 1.0, nan], [2.0, nan, nan], [nan, 3.0, nan], [4.0, nan, nan]])
    expected = [[2.0, 1.0, nan], [2.0, 2.0, nan], [3.0, 3.0, nan], [4.0, 3.0, nan]]
    np.testing.assert_array_equal(interpolated(rows), expected)
