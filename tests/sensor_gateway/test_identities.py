"""People keep their numbers: from image to image, unseen for a moment, and passing one another."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS
from sensor_gateway.people.identities import Identities

FRAME_S = 1 / 20
Place = np.ndarray


def numbers(frames: Sequence[Sequence[Place]], interval_s: float = FRAME_S) -> list[list[int]]:
    people = Identities()
    return [people.step(round(i * interval_s * SECOND_NS), places) for i, places in enumerate(frames)]


def walk(start_m: Sequence[float], velocity_mps: Sequence[float], seconds: float = 4.0) -> list[Place]:
    times = np.arange(0, seconds, FRAME_S)
    return [np.array(start_m) + t * np.array(velocity_mps) for t in times]


def noisy(path: Sequence[Place], seed: int) -> list[Place]:
    """Three centimetres across the line of sight, six per cent along it."""
    rng = np.random.default_rng(seed)
    return [(place + rng.normal(0, 0.03, 3)) * (1 + rng.normal(0, 0.06)) for place in path]


def test_numbers_begin_at_one_and_rise_with_each_newcomer() -> None:
    here, there = np.array([-0.5, 0, 2.5]), np.array([0.8, 0, 2.5])
    assert numbers([[], [here], [here, there], [there, here]]) == [[], [1], [1, 2], [2, 1]]


@given(seed=st.integers(0, 10_000), order=st.lists(st.booleans(), min_size=80, max_size=80))
def test_two_who_pass_each_other_keep_their_numbers_in_whatever_order_they_are_found(
    seed: int, order: list[bool]
) -> None:
    one = noisy(walk([-1.0, 0, 2.0], [0.5, 0, 0]), seed)
    other = noisy(walk([1.0, 0, 3.0], [-0.5, 0, 0]), seed + 1)
    frames = [[b, a] if swap else [a, b] for a, b, swap in zip(one, other, order, strict=True)]
    told = [found[::-1] if swap else found for found, swap in zip(numbers(frames), order, strict=True)]
    assert all(found == told[0] for found in told)


@given(seed=st.integers(0, 10_000))
def test_the_one_behind_gets_their_number_back_on_the_other_side(seed: int) -> None:
    one = noisy(walk([-1.0, 0, 2.0], [0.5, 0, 0]), seed)
    other = noisy(walk([1.0, 0, 3.0], [-0.5, 0, 0]), seed + 1)
    hidden = [abs(a[0] / a[2] - b[0] / b[2]) < 0.12 for a, b in zip(one, other, strict=True)]
    assert 5 < sum(hidden) < 20
    frames = [[a] if gone else [a, b] for a, b, gone in zip(one, other, hidden, strict=True)]
    assert [told for told, gone in zip(numbers(frames), hidden, strict=True) if not gone] == [[1, 2]] * hidden.count(
        False
    )


def test_somebody_unseen_for_a_second_is_still_the_same() -> None:
    still = [np.array([0.3, 0, 2.5])]
    assert numbers([still, still, *[[]] * 18, still])[-1] == [1]


def test_somebody_who_comes_back_later_is_somebody_new_and_no_number_is_given_twice() -> None:
    still = [np.array([0.3, 0, 2.5])]
    assert numbers([still, *[[]] * 40, still])[-1] == [2]


def test_nobody_leaps_across_the_room() -> None:
    assert numbers([[np.array([-1.0, 0, 2.5])], [np.array([1.0, 0, 2.5])]]) == [[1], [2]]


def test_a_distance_that_is_misjudged_does_not_make_somebody_new() -> None:
    assert numbers([[np.array([0.2, 0, 2.5])], [np.array([0.25, 0, 3.1])]]) == [[1], [1]]


@given(st.lists(st.lists(st.tuples(st.floats(-2, 2), st.floats(1, 5)), max_size=4), max_size=12))
def test_each_position_gets_a_number_and_none_twice(frames: list[list[tuple[float, float]]]) -> None:
    for found, places in zip(
        numbers([[np.array([x, 0.0, z]) for x, z in frame] for frame in frames]), frames, strict=True
    ):
        assert len(found) == len(places) == len(set(found))


def test_those_who_are_expected_back_are_known() -> None:
    people = Identities()
    people.step(0, [np.array([0.0, 0, 2.0])])
    people.step(SECOND_NS, [])
    assert people.expected == {1}
    people.step(3 * SECOND_NS, [])
    assert people.expected == frozenset()


@pytest.mark.parametrize("first", [0, 10**18])
def test_only_differences_of_stamps_matter(first: int) -> None:
    people = Identities()
    place = np.array([0.0, 0, 2.0])
    assert [people.step(first + i * 50_000_000, [place]) for i in range(3)] == [[1]] * 3
