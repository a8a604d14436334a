"""The compiled kernel against the one in NumPy: the same map to the bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.core import steps
from actum.som import Schedule, SequentialTraining, Som, adapt_in_numpy, sequential
from actum.som.kernel import Kernel, adapt_compiled

needs_compiler = pytest.mark.skipif(steps is None, reason="this installation found no C compiler")


def trained(som: Som, vectors: np.ndarray, kernel: Kernel) -> np.ndarray:
    order = np.random.default_rng(5).integers(len(vectors), size=150)
    training = SequentialTraining(som, vectors, order, Schedule((0.6, 0.05), (4.0, 0.3)), kernel)
    training.run(150)
    return training.som.weights


@needs_compiler
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@given(
    rows=st.integers(1, 9),
    cols=st.integers(1, 9),
    dim=st.integers(1, 13),
    gaps=st.sampled_from([0.0, 0.3]),
    seed=st.integers(0, 99),
)
def test_both_kernels_give_the_same_map_to_the_bit(
    rows: int, cols: int, dim: int, gaps: float, seed: int, dtype: type
) -> None:
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(20, dim)).astype(dtype)
    vectors[:, 1:][rng.random((20, dim - 1)) < gaps] = np.nan
    som = Som.random(rows, cols, dim, rng, dtype)
    assert trained(som, vectors, adapt_compiled).tobytes() == trained(som, vectors, adapt_in_numpy).tobytes()


@needs_compiler
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_both_kernels_take_the_first_of_equals(dtype: type) -> None:
    som = Som(3, 5, np.zeros((15, 2)).astype(dtype))
    vectors = np.array([[1.0, 1.0]], dtype)
    for kernel in (adapt_in_numpy, adapt_compiled):
        weights = trained(som, vectors, kernel)
        assert weights[:, 0].argmax() == 0
    assert (trained(som, vectors, adapt_in_numpy) == trained(som, vectors, adapt_compiled)).all()


def test_without_the_compiled_kernel_maps_learn_by_the_one_in_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sequential, "steps", None)
    assert sequential.fastest_kernel() is adapt_in_numpy


@needs_compiler
def test_a_map_of_more_units_than_columns_is_refused() -> None:
    with pytest.raises(ValueError, match="more units than the weights have columns"):
        adapt_compiled(np.zeros((1, 3)), np.ones((1, 1)), np.ones((1, 2)), np.ones((1, 2)))


@needs_compiler
def test_half_precision_is_refused() -> None:
    """It was taken for double, and what lies behind the arrays was written to."""
    with pytest.raises(ValueError, match="neither single nor double"):
        adapt_compiled(*(np.ones((2, 2), np.float16) for _ in range(4)))
