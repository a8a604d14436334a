import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum_model_inspector.label_placement import LabelSpace, spread_apart, text_size

heights = st.lists(st.floats(-1, 1), max_size=8)


@given(heights)
def test_names_are_spread_a_distance_apart_in_their_order(wanted: list[float]) -> None:
    places = spread_apart(wanted, 0.1)
    ordered = [place for _, place in sorted(zip(wanted, places, strict=True), key=lambda pair: pair[0])]
    assert all(after - before >= 0.1 - 1e-9 for before, after in itertools.pairwise(sorted(places)))
    assert ordered == pytest.approx(sorted(places))


@given(heights)
def test_spreading_keeps_the_mean(wanted: list[float]) -> None:
    assert sum(spread_apart(wanted, 0.1)) == pytest.approx(sum(wanted), abs=1e-9)


def test_what_is_far_enough_apart_stays() -> None:
    assert spread_apart([0.5, 0.0, 0.2], 0.1) == pytest.approx([0.5, 0.0, 0.2])


def test_a_name_takes_the_first_place_with_room() -> None:
    space = LabelSpace((0, 0, 10, 10))
    assert space.place([(5, 5)], 4, 2) == (5, 5)
    assert space.place([(6, 5), (5, 8)], 4, 2) == (5, 8)
    assert space.place([(5, 5.5), (9.5, 1)], 4, 2) is None


def test_a_box_is_moved_onto_the_page() -> None:
    space = LabelSpace((0, 0, 10, 10))
    assert space.moved_inside(0, 11, 4, 2) == (2, 9)
    assert space.moved_inside(5, 5, 4, 2) == (5, 5)


def test_longer_names_are_wider_and_more_lines_higher() -> None:
    assert text_size("abcd", 1) == pytest.approx((2 * text_size("ab", 1)[0], text_size("ab", 1)[1]))
    assert text_size("ab\ncd", 1)[1] == pytest.approx(2 * text_size("ab", 1)[1])
