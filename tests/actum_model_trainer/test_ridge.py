"""Ridge regression: both forms give the same, and coordinates in enough directions give what the vectors do."""

import numpy as np
import pytest

from actum_model_trainer.basis import Basis
from actum_model_trainer.products import inner_products, inverse_root, solution
from actum_model_trainer.ridge import DualForm, DualRidge, PrimalRidge, ridge

SHRINKAGE = 0.2
COUNT = 20
"""Rows of actions; the others are background."""


def rows(inputs: int = 12) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    vectors = (rng.normal(size=(30, inputs)) + 2).astype(np.float32)
    indicators = np.zeros((30, 3))
    indicators[np.arange(COUNT), np.arange(COUNT) % 3] = 1
    return vectors, indicators


def answers(fitted: DualRidge | PrimalRidge) -> list[np.ndarray]:
    folds = [np.array([1, 4, 5]), np.array([0, 2])]
    left_out = [*fitted.held_out(folds), fitted.each_left_out(COUNT)]
    return [fitted.axes, fitted.offsets, fitted.scores, *left_out]


@pytest.mark.parametrize("inputs", [5, 12, 40])
def test_the_dual_and_the_primal_form_give_the_same(inputs: int) -> None:
    vectors, indicators = rows(inputs)
    dual = DualRidge(DualForm.of(vectors, SHRINKAGE), indicators)
    for one, other in zip(answers(dual), answers(PrimalRidge(vectors, indicators, SHRINKAGE)), strict=True):
        np.testing.assert_allclose(one, other, atol=2e-5)


def ill_conditioned(count: int) -> np.ndarray:
    """Inner products like those of pooled windows: what they have in common is longer than the penalty by far."""
    rng = np.random.default_rng(count)
    vectors = rng.random((count, 60)) + 20
    return vectors @ vectors.T + np.eye(count)


@pytest.mark.parametrize("count", [1, 5, 128, 129, 700, 2500])
def test_a_system_of_equations_is_solved_even_where_all_vectors_lie_on_a_line(count: int) -> None:
    """The condition of inner products with a penalty is largest there: the number of vectors by the shrinkage."""
    rng = np.random.default_rng(count)
    along = rng.normal(size=count)
    matrix = (np.outer(along, along) + SHRINKAGE * np.square(along).mean() * np.eye(count)).astype(np.float32)
    expected = rng.random((count, 3))
    np.testing.assert_allclose(solution(matrix, matrix.astype(np.float64) @ expected), expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("count", [1, 5, 128, 129, 700])
def test_the_square_of_the_inverse_root_is_the_inverse(count: int) -> None:
    matrix = ill_conditioned(count)
    root = inverse_root(matrix)
    np.testing.assert_allclose(root.T @ root @ matrix, np.eye(count), rtol=0, atol=1e-6)


@pytest.mark.parametrize("count", [5, 999, 1001])
def test_inner_products_of_halves_are_the_inner_products(count: int) -> None:
    vectors = np.random.default_rng(count).normal(size=(count, 40)).astype(np.float32)
    np.testing.assert_allclose(inner_products(vectors), vectors.astype(np.float64) @ vectors.T, atol=1e-4)


def test_the_form_with_the_smaller_matrix_is_taken() -> None:
    assert isinstance(ridge(*rows(40), SHRINKAGE), DualRidge)
    assert isinstance(ridge(*rows(12), SHRINKAGE), PrimalRidge)


def test_as_many_directions_as_inputs_change_nothing() -> None:
    vectors, indicators = rows()
    basis = Basis.of(vectors, 12)
    whole, reduced = (PrimalRidge(each, indicators, SHRINKAGE) for each in (vectors, basis.coordinates(vectors)))
    np.testing.assert_allclose(whole.scores, reduced.scores, atol=1e-5)
    axes = basis.axes(reduced.axes)
    np.testing.assert_allclose(whole.axes, axes, atol=1e-5)
    np.testing.assert_allclose(whole.offsets, basis.offsets(reduced.offsets, axes), atol=1e-5)


def test_coordinates_can_be_moved_to_another_basis() -> None:
    vectors, _ = rows()
    one, other = Basis.of(vectors, 12), Basis.of(vectors[5:20] + 1, 12)
    moved = one.moved(one.coordinates(vectors), other)
    np.testing.assert_allclose(moved, other.coordinates(vectors), atol=1e-4)


def test_vectors_that_are_all_the_same_have_no_direction() -> None:
    assert Basis.of(np.ones((4, 6), np.float32), 3).rank == 0
