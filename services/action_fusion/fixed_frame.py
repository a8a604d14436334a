"""The setting of the transform from the camera frame to a fixed frame; events give object poses in both frames."""

import re
from pathlib import Path

import numpy as np

from actum import geometry
from actum.arrays import Array

REMEDY = (
    "give the 16 numbers of a 4x4 matrix, row by row, in metres, or the name of a file that contains only these numbers"
)
MOST_CHARACTERS = 10_000
"""Characters read of a file: 16 numbers take 400 at most."""

FURTHEST_M = 1e6
"""Largest translation in metres: more is a mistake in the unit."""

SEPARATORS = re.compile(r"[\s,;\[\]]+")
"""Separators between numbers, in lists as NumPy, JSON and MATLAB write them."""


def as_text(value: object) -> str | None:
    """Write a rigid transform as its 16 numbers; the value is a list of them, text that lists them, or a file's name.

    Raises:
        ValueError: the value is no rigid transform, or the file cannot be read.
    """
    if value is None:
        return None
    text = value if isinstance(value, str) else str(value)
    numbers = _numbers(text)
    if numbers is None:
        numbers = _numbers(_content(text))
    if numbers is None or len(numbers) != 16:
        raise ValueError(f"{text!r} is not a rigid transform: {REMEDY}")
    if not geometry.is_rigid(np.array(numbers).reshape(4, 4), FURTHEST_M):
        raise ValueError(
            f"{text!r} is not a rigid transform: the 4x4 matrix must consist of a rotation without scaling or "
            "mirroring, a position in metres, and 0 0 0 1 as the last row"
        )
    return " ".join(map(repr, numbers))


def from_text(text: str) -> Array:
    """Read the transform (4, 4) that `as_text` wrote."""
    return geometry.from_flat([float(number) for number in text.split()])


def _numbers(text: str) -> list[float] | None:
    """Read the numbers that a text lists; None where it lists anything else."""
    try:
        return [float(word) for word in SEPARATORS.split(text) if word]
    except ValueError:
        return None


def _content(name: str) -> str:
    try:
        with Path(name).open(encoding="utf-8") as file:
            return file.read(MOST_CHARACTERS)
    except (OSError, ValueError) as error:
        raise ValueError(f"{name!r} is neither a list of numbers nor a readable file ({error}): {REMEDY}") from None
