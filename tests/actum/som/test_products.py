"""Products in tiles are those of NumPy, however many tiles they take."""

import numpy as np
import pytest

from actum.som.blas import few_rows_matmul, matmul


@pytest.mark.parametrize("rows", [1, 3, 300])
@pytest.mark.parametrize(("inner", "width"), [(3, 4), (128, 2048), (130, 2100), (300, 5000)])
def test_a_product_is_numpys_of_any_size(rows: int, inner: int, width: int) -> None:
    rng = np.random.default_rng(0)
    left, right = rng.normal(size=(rows, inner)), rng.normal(size=(inner, width))
    np.testing.assert_allclose(matmul(left, right), left @ right, atol=1e-10)
    np.testing.assert_allclose(few_rows_matmul(left[:3], right), left[:3] @ right, atol=1e-10)
