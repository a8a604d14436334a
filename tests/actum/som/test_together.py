"""Several maps asked at once answer as each does alone."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from actum.som import Som, Together


def maps_of(*dims: int, units: tuple[int, int] = (4, 5), dtype: type = np.float32) -> list[Som]:
    rng = np.random.default_rng(0)
    return [Som(*units, (rng.normal(2, 1, (units[0] * units[1], dim))).astype(dtype)) for dim in dims]


@settings(deadline=None, max_examples=20)
@given(st.lists(st.integers(1, 40), min_size=1, max_size=4), st.integers(1, 5))
@example([8, 34], 4)
def test_each_map_answers_as_alone(dims: list[int], count: int) -> None:
    maps = maps_of(*dims)
    inputs = [np.random.default_rng(1).normal(2, 1, (count, dim)) for dim in dims]
    found = Together(maps).excess2s(np.concatenate(inputs, axis=1))
    assert found.dtype == np.float32
    for k, (som, own) in enumerate(zip(maps, inputs, strict=True)):
        np.testing.assert_allclose(found[:, k], som.excess2s(own), atol=1e-4)
        assert (found[:, k].argmin(axis=1) == som.bmus(own)).all()


@pytest.mark.parametrize("units", [(4, 5), (60, 60)])
def test_of_any_size_by_distances(units: tuple[int, int]) -> None:
    """The larger exceeds what BLAS multiplies on one thread."""
    maps = maps_of(45, 12, units=units, dtype=np.float64)
    x = np.random.default_rng(2).normal(2, 1, (2, 57))
    inputs = np.split(x, [45], axis=1)
    expected = np.stack(
        [np.square(own[:, None] - som.weights).sum(axis=2) for som, own in zip(maps, inputs, strict=True)], axis=1
    )
    smallest = np.min(expected, axis=2, keepdims=True)
    np.testing.assert_allclose(Together(maps).excess2s(x), expected - smallest, atol=1e-9)


def test_maps_must_be_alike() -> None:
    with pytest.raises(ValueError, match="differ in their numbers of units or in their data types"):
        Together([*maps_of(3), *maps_of(3, units=(2, 2))])
    with pytest.raises(ValueError, match="differ in their numbers of units or in their data types"):
        Together([*maps_of(3), *maps_of(3, dtype=np.float64)])
