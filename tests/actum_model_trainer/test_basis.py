"""A basis holds the directions in which vectors differ, and is extended by those that others have beside them."""

import numpy as np
import pytest

from actum_model_trainer.basis import Basis


def vectors(seed: int, rank: int, scale: float = 1.0) -> np.ndarray:
    """Vectors (40, 200) that differ in so many directions."""
    rng = np.random.default_rng(seed)
    return (scale * rng.normal(size=(40, rank)) @ rng.normal(size=(rank, 200)) + 5).astype(np.float32)


def test_vectors_that_a_basis_holds_already_add_no_direction() -> None:
    basis = Basis.of(vectors(1, 6), 20)
    assert basis.extended(vectors(1, 6), 20).rank == basis.rank == 6


@pytest.mark.parametrize("scale", [1.0, 1e-2])
def test_added_directions_are_orthogonal_to_those_before_also_where_they_matter_little(scale: float) -> None:
    basis = Basis.of(vectors(1, 6), 20)
    extended = basis.extended(vectors(1, 6) + vectors(2, 3, scale) - 5, 20)
    assert extended.rank == 9
    np.testing.assert_allclose(extended.directions.T @ extended.directions, np.eye(9), atol=2e-6)


def test_differences_of_rounding_add_no_direction() -> None:
    basis = Basis.of(vectors(1, 6), 20)
    assert basis.extended(vectors(1, 6) + vectors(2, 3, 1e-4) - 5, 20).rank == 6
