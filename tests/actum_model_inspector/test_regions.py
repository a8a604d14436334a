import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from actum_model_inspector.action_map import borders, spread_on_unit
from actum_model_inspector.regions import innermost_unit, largest_component, regions

masks = arrays(bool, st.tuples(st.integers(1, 7), st.integers(1, 7)))


def test_each_unit_belongs_to_the_action_that_answers_most_there() -> None:
    answers = np.array([[0.9, 0.1], [0.6, 0.4], [0.5, 0.5], [0.0, 0.4]])
    found = regions(answers, 2, 2)
    assert found.actions.tolist() == [[0, 0], [0, 1]]
    assert found.margins == pytest.approx(np.array([[1.0, 0.25], [0.0, 0.5]]))


def test_where_all_answer_alike_there_is_no_margin() -> None:
    assert regions(np.zeros((4, 3)), 2, 2).margins.tolist() == [[0, 0], [0, 0]]


def test_the_largest_of_several_components_is_found() -> None:
    mask = np.array([[1, 0, 1, 1], [0, 0, 0, 1], [1, 1, 0, 0]], dtype=bool)
    assert largest_component(mask).tolist() == [[0, 2], [0, 3], [1, 3]]


@given(masks)
def test_a_component_lies_within_its_mask_and_its_innermost_unit_within_it(mask: np.ndarray) -> None:
    component = largest_component(mask)
    assert (len(component) == 0) == (not mask.any())
    assert all(mask[row, col] for row, col in component)
    if len(component):
        assert list(innermost_unit(component)) in component.tolist()


def test_the_innermost_unit_of_a_square_is_its_middle_and_that_of_a_hook_is_on_the_hook() -> None:
    assert innermost_unit(largest_component(np.ones((5, 5), dtype=bool))) == (2, 2)
    hook = np.zeros((7, 7), dtype=bool)
    hook[:3, :3] = hook[1, :] = hook[:, 1] = True
    assert innermost_unit(largest_component(hook)) == (1, 1)


def test_borders_run_between_units_of_different_actions_only() -> None:
    edges = borders(np.array([[0, 1], [0, 0]]))
    assert [edge.tolist() for edge in edges] == [[[0.5, -0.5], [0.5, 0.5]], [[0.5, 0.5], [1.5, 0.5]]]


@given(arrays(np.intp, st.integers(0, 40), elements=st.integers(0, 3)))
def test_dots_on_one_unit_lie_apart_and_inside_it(units: np.ndarray) -> None:
    aside = spread_on_unit(units)
    assert np.abs(aside).max(initial=0) < 0.5
    places = [(unit, *place) for unit, place in zip(units.tolist(), aside.round(6).tolist(), strict=True)]
    assert len(set(places)) == len(places)
