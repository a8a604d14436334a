from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scene_simulator.programme import ACTIONS, Task, balanced_programme


@given(st.integers(1, 20), st.integers(0, 1000))
def test_every_action_is_repeated_equally_and_the_objects_take_turns(repetitions: int, seed: int) -> None:
    programme = balanced_programme(repetitions, seed)

    assert Counter(task.action for task in programme) == dict.fromkeys(ACTIONS, repetitions)
    for action in ACTIONS:
        counts = [Counter(s.object_id for s in programme if s.action == action)[i] for i in (1, 2, 3)]
        assert max(counts) - min(counts) <= 1


@given(st.integers(1, 5), st.integers(0, 1000), st.integers(0, 100))
def test_no_action_tells_its_object_over_people(repetitions: int, seed: int, first: int) -> None:
    programmes = [balanced_programme(repetitions, seed, person) for person in range(first, first + 3)]
    pairs = Counter((task.action, task.object_id) for programme in programmes for task in programme)

    assert pairs == {(action, number): repetitions for action in ACTIONS for number in (1, 2, 3)}
    for programme in programmes:
        assert Counter(task.action for task in programme) == dict.fromkeys(ACTIONS, repetitions)
        assert {task.object_id for task in programme} == {1, 2, 3}


def test_the_order_comes_from_the_seed() -> None:
    assert balanced_programme(4, 7) == balanced_programme(4, 7)
    assert balanced_programme(4, 7) != balanced_programme(4, 8)


@pytest.mark.parametrize(("action", "object_id"), [("throw", 1), ("push", 4), ("push", 0), ("push", -1)])
def test_an_action_or_object_that_does_not_exist_is_named(action: str, object_id: int) -> None:
    with pytest.raises(ValueError, match=r"'throw' is not an action|(4|0|-1) is not the id"):
        Task(action, object_id)
