"""Errors and U-matrix, by hand."""

import numpy as np
import pytest

from actum.som import Som
from map_cases import line_map


def test_quantization_error_is_the_mean_distance_to_the_winner() -> None:
    assert line_map().quantization_error(np.array([[0.5], [13.0]])) == pytest.approx((0.5 + 3.0) / 2)


def test_topographic_error_is_the_share_whose_best_two_are_apart() -> None:
    """The best two of 0.4, 2.4 and 3.6 stand at columns 0 and 2, 3 and 2, 3 and 1."""
    som = Som(1, 4, np.array([[0.0], [5.0], [1.0], [3.0]]))
    assert som.topographic_error(np.array([[0.4], [2.4], [3.6]])) == pytest.approx(2 / 3)


def test_diagonal_neighbours_are_neighbours_among_eight_not_among_four() -> None:
    som = Som(2, 2, np.array([[0.0], [9.0], [9.0], [1.0]]))
    assert som.topographic_error(np.array([[0.4]])) == 0
    assert som.topographic_error(np.array([[0.4]]), neighbours=8) == 0
    assert som.topographic_error(np.array([[0.4]]), neighbours=4) == 1


def test_neighbours_that_a_grid_does_not_have_are_refused() -> None:
    with pytest.raises(ValueError, match="'neighbours' is 6: use 8 or 4"):
        Som(2, 2, np.zeros((4, 1))).topographic_error([[0.4]], 6)


@pytest.mark.parametrize(("rows", "cols"), [(0, 3), (3, 0), (-1, -1)])
def test_grids_that_make_no_sense_are_refused(rows: int, cols: int) -> None:
    with pytest.raises(ValueError, match=f"a grid of {rows}×{cols} units needs"):
        Som(rows, cols, np.zeros((rows * cols, 1)))
    with pytest.raises(ValueError, match=f"a map of {rows}×{cols} units is empty"):
        Som.linear(rows, cols, [[1.0], [2.0]])


def test_u_matrix_is_the_mean_distance_to_the_neighbours() -> None:
    assert line_map().u_matrix().tolist() == [[1, 5, 9]]
    som = Som(2, 2, np.array([[0.0], [3.0], [6.0], [12.0]]))
    assert som.u_matrix().tolist() == [[7, 5], [5, 9]]
    assert Som(1, 1, np.zeros((1, 1))).u_matrix().tolist() == [[0]]


def test_no_vectors_measure_nothing() -> None:
    for measure in (line_map().quantization_error, line_map().topographic_error):
        with pytest.raises(ValueError, match="no input vectors"):
            measure(np.zeros((0, 1)))
