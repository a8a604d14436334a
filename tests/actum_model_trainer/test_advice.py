"""What examples cannot teach is said in sentences, with what to record next."""

from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from actum_model_trainer.advice import Contents, advice
from actum_model_trainer.samples import SegmentSample

NOTHING = np.zeros(0)
ENOUGH = {"push": 6, "pull": 6, "idle": 6}


def examples(counts: Mapping[str, int], people: tuple[str, ...] = ("anna", "ben")) -> list[SegmentSample]:
    """Make so many examples of each label, done by the people in turn."""
    labels = [label for label, n in counts.items() for _ in range(n)]
    return [
        SegmentSample(label, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, people[i % len(people)], "a.mcap", str(i))
        for i, label in enumerate(labels)
    ]


def advised(samples: Sequence[SegmentSample], answers: Sequence[tuple[str, str]] = ()) -> list[str]:
    return advice(Contents.of(samples, 0.0), answers)


@pytest.mark.parametrize(
    "counts",
    [ENOUGH, {"push": 18, "pull": 6, "idle": 6}, {"push": 6, "pull": 6, "idle": 100, "background": 2}],
    ids=["enough of each", "three times as many of one", "any amount of background"],
)
def test_enough_examples_by_two_people_with_background_need_no_warning(counts: Mapping[str, int]) -> None:
    assert advised(examples(counts), [("push", "push"), ("pull", "pull")] * 6) == []


@pytest.mark.parametrize(
    ("counts", "people", "said"),
    [
        ({}, ("anna", "ben"), "There are no examples yet: record at least two actions."),
        (
            {"push": 6, "idle": 6},
            ("anna", "ben"),
            "There are examples of only one action, push: record at least one more action.",
        ),
        (
            ENOUGH,
            ("anna",),
            "All examples show the same person, anna: record 5 examples of each action, performed by a second person.",
        ),
        (
            ENOUGH,
            ("",),
            "The examples do not name the people who perform them, so the model cannot learn how people differ: "
            "record at least two people, and give the name of each.",
        ),
        (
            {"push": 2, "lift": 4, "pull": 5, "idle": 5},
            ("anna", "ben"),
            "Too few examples: lift has 4 (1 more needed) and push has 2 (3 more needed). Record at least 5 examples "
            "of each action.",
        ),
        (
            {"push": 20, "pull": 6, "lift": 5, "turn": 7, "idle": 5},
            ("anna", "ben"),
            "Unbalanced examples: push has 20 examples, more than 3 times as many as lift (5) and pull (6). Record 2 "
            "more of lift and 1 more of pull.",
        ),
    ],
    ids=["no example", "one action", "one person", "nobody named", "few", "unbalanced"],
)
def test_what_is_lacking_is_said_with_what_to_record(
    counts: Mapping[str, int], people: tuple[str, ...], said: str
) -> None:
    assert advised(examples(counts, people)) == [said]


def test_without_background_what_is_none_of_the_actions_is_a_guess() -> None:
    (said,) = advised(examples({"push": 6, "pull": 6}))
    assert said.startswith("There are only 0 s of background") and said.endswith("record at least 60 s more.")
    (said,) = advice(Contents.of(examples({"push": 6, "pull": 6}), 22.0))
    assert said.startswith("There are only 22 s of background") and said.endswith("record at least 38 s more.")
    assert advice(Contents.of(examples({"push": 6, "pull": 6}), 60.0)) == []
    assert advised(examples({"push": 6, "pull": 6, "background": 6})) == []


@pytest.mark.parametrize(
    ("held_out", "said"),
    [
        (
            [("push", "push")] * 4 + [("push", "pull")] * 2 + [("pull", "pull")] * 2,
            "The model confuses pull and push: in a test on examples left out of the training, push was taken for "
            "pull in 2 of 6. Record 5 more examples of each of the two actions, performed by other people, ",
        ),
        (
            [("push", "push")] * 3 + [("push", "pull")] + [("pull", "pull")] * 3 + [("pull", "push")],
            "The model confuses pull and push: in a test on examples left out of the training, pull was taken for "
            "push in 1 of 4 and push was taken for pull in 1 of 4. Record 5 more examples of each of the two actions, "
            "performed by other people, ",
        ),
    ],
)
def test_two_actions_that_are_mixed_up_are_named_with_what_to_record(
    held_out: list[tuple[str, str]], said: str
) -> None:
    (warning,) = advised(examples(ENOUGH), held_out)
    assert warning.startswith(said)
    assert warning.endswith("or make the two actions more different.")


@pytest.mark.parametrize(
    "held_out",
    [
        [("push", "pull")],
        [("push", "pull")] * 2 + [("push", "push")] * 4 + [("pull", "pull")] * 3,
        [("push", "pull"), ("push", "lift"), *[("push", "push")] * 2],
    ],
    ids=["a single mistake", "less than a quarter", "two mistakes of different kinds"],
)
def test_now_and_then_a_mistake_is_no_warning(held_out: list[tuple[str, str]]) -> None:
    assert advised(examples(ENOUGH), held_out) == []


def test_the_pair_that_is_mixed_up_most_comes_first() -> None:
    held_out = [("push", "pull")] * 2 + [("lift", "turn")] * 3
    first, second = advised(examples(ENOUGH), held_out)
    assert first.startswith("The model confuses lift and turn") and second.startswith(
        "The model confuses pull and push"
    )
