"""Conversion of input vectors to arrays, and checks of them; NaN stands for a missing component."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]


def some_rows(vectors: ArrayLike) -> Array:
    """Return the vectors (n, dim) as an array; see `numbers`.

    Raises:
        ValueError: there is none.
    """
    rows = numbers(vectors)
    if not len(rows):
        raise ValueError(
            "no input vectors are given, so the error of the map cannot be computed: give at least one vector"
        )
    return rows


def float_type(values: ArrayLike) -> np.dtype[np.floating]:
    """Return float32 for float32 values, float64 for all others."""
    return np.dtype(np.float32 if np.asarray(values).dtype == np.float32 else np.float64)


def numbers(values: ArrayLike) -> Array:
    """Return values as an array in their own precision, in double where they are no floats; None is NaN."""
    array = np.asarray(values)
    return array if array.dtype.kind == "f" else np.asarray(values, np.float64)


def check_squarable(values: Array) -> None:
    """Check that squared distances between values (n, dim) do not overflow their precision.

    Raises:
        ValueError: they do; the text names the largest value.
    """
    largest = np.nanmax(np.abs(values))
    if largest > np.sqrt(np.finfo(values.dtype).max / values.shape[1]) / 4:
        raise ValueError(
            f"the largest value, {largest:.0e}, is too large to compute distances in {values.dtype}: scale the values "
            "down"
        )


def training_vectors(vectors: ArrayLike, dim: int, dtype: np.dtype[np.floating]) -> Array:
    """Return a copy of the vectors to learn from, (n, dim), in a map's precision.

    Raises:
        ValueError: there is no vector, they have another length, or one is infinite, too large to be squared, or has
            no known component.
    """
    inputs = np.array(vectors, dtype=dtype, order="C")
    if inputs.ndim != 2 or inputs.shape[1] != dim or not len(inputs):
        raise ValueError(
            f"cannot train on vectors of the shape {inputs.shape}: give an array of the shape (number of vectors, "
            f"{dim}), with at least one vector"
        )
    try:
        is_complete(inputs)
        check_squarable(inputs)
    except ValueError as error:
        raise ValueError(f"cannot train on these vectors, because {error}") from None
    return inputs


def is_complete(vectors: Array) -> bool:
    """Tell whether no component of the rows (n, dim) is missing.

    Raises:
        ValueError: a component is infinite, or every component of a row is missing.
    """
    if np.isfinite(vectors).all():
        return True
    if np.isinf(vectors).any():
        row = np.flatnonzero(np.isinf(vectors).any(axis=1))[0]
        raise ValueError(
            f"row {row} of the vectors contains an infinite value: remove this row, or replace the infinite value"
        )
    empty = np.isnan(vectors).all(axis=1)
    if empty.any():
        row = np.flatnonzero(empty)[0]
        raise ValueError(
            f"row {row} of the vectors contains only NaN: remove this row, or replace at least one NaN by a number"
        )
    return False
