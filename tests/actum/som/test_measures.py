"""Errors, U-matrix and hits, by hand."""

import numpy as np
import pytest

from actum.som import Grid, Som


def line_map() -> Som:
    """Three neurons in a row at 0, 1 and 10 on the number line."""
    return Som(1, 3, np.array([[0.0], [1.0], [10.0]]))


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


def test_on_a_hexagonal_grid_a_unit_touches_six() -> None:
    """Odd rows are shifted right: (1, 1) touches (0, 1) and (0, 2), but not (0, 0)."""
    grid = Grid(3, 4, "hexagonal")
    first, second = grid.edges()
    assert sorted(second[first == 5].tolist()) == [1, 2, 4, 6, 9, 10]
    assert sorted(second[first == 1].tolist()) == [0, 2, 4, 5]
    np.testing.assert_allclose(np.linalg.norm(grid.positions[first] - grid.positions[second], axis=1), 1.0)


def test_on_a_hexagonal_grid_the_best_two_are_judged_by_six() -> None:
    weights = np.full((4, 1), 9.0)
    weights[1], weights[2] = 0.0, 1.0
    assert Som(2, 2, weights, "hexagonal").topographic_error([[0.4]]) == 0
    weights[[0, 3]], weights[[1, 2]] = [[0.0], [1.0]], 9.0
    assert Som(2, 2, weights, "hexagonal").topographic_error([[0.4]]) == 1


@pytest.mark.parametrize(("topology", "neighbours"), [("rectangular", 6), ("hexagonal", 4), ("hexagonal", 8)])
def test_neighbours_that_a_grid_does_not_have_are_refused(topology: str, neighbours: int) -> None:
    som = Som(2, 2, np.zeros((4, 1)), topology)
    with pytest.raises(ValueError, match="neighbours, not"):
        som.topographic_error([[0.4]], neighbours)
    with pytest.raises(ValueError, match="neighbours, not"):
        som.u_matrix(neighbours)


def test_grids_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="no units"):
        Grid(0, 3)
    with pytest.raises(ValueError, match="'round' is not a topology: use rectangular, hexagonal"):
        Som(1, 1, np.zeros((1, 1)), "round")  # type: ignore[arg-type]


def test_u_matrix_is_the_mean_distance_to_the_neighbours() -> None:
    assert line_map().u_matrix().tolist() == [[1, 5, 9]]
    som = Som(2, 2, np.array([[0.0], [3.0], [6.0], [12.0]]))
    assert som.u_matrix(4).tolist() == [[4.5, 6], [6, 7.5]]
    assert som.u_matrix().tolist() == [[7, 5], [5, 9]]
    assert Som(2, 2, som.weights, "hexagonal").u_matrix().tolist() == [[4.5, 5], [5, 7.5]]
    assert Som(1, 1, np.zeros((1, 1))).u_matrix().tolist() == [[0]]


def test_hits_count_the_wins_of_each_unit() -> None:
    som = Som(2, 2, np.array([[0.0], [3.0], [6.0], [12.0]]))
    assert som.hits([[0.1], [6.1], [5.9], [100.0]]).tolist() == [[1, 0], [2, 1]]


def test_no_vectors_measure_nothing() -> None:
    for measure in (line_map().quantization_error, line_map().topographic_error):
        with pytest.raises(ValueError, match="no vectors"):
            measure(np.zeros((0, 1)))
