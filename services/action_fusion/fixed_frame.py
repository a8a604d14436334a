"""The transform from the camera frame to a fixed one, as a setting gives it: events tell object poses in both."""

import re
from pathlib import Path

import numpy as np

from actum import geometry
from actum.arrays import Array

FORM = "16 numbers of a rigid 4x4 transform (rows one after the other, metres), or a file that holds just these"
MOST_CHARACTERS = 10_000
"""So much of a file is read: 16 numbers at their longest take 400."""

FURTHEST_M = 1e6
"""Largest translation: more is a mistake in the unit."""

SEPARATORS = re.compile(r"[\s,;\[\]]+")
"""What may stand between numbers: lists as NumPy, JSON and MATLAB write them."""


def as_text(given: object) -> str | None:
    """Write a rigid transform as its 16 numbers, from numbers, from text that lists them, or from the file it names.

    Raises:
        ValueError: it is no such transform, or the file cannot be read.
    """
    if given is None:
        return None
    text = given if isinstance(given, str) else str(given)
    numbers = _numbers(text)
    if numbers is None:
        numbers = _numbers(_content(text))
    if numbers is None or len(numbers) != 16:
        raise ValueError(f"{text!r} is not {FORM}")
    if not geometry.is_rigid(np.array(numbers).reshape(4, 4), FURTHEST_M):
        raise ValueError(f"{text!r} is no rigid transform: a rotation, a position, and 0 0 0 1 below them")
    return " ".join(map(repr, numbers))


def from_text(text: str) -> Array:
    """Read the transform (4, 4) that `as_text` wrote."""
    return geometry.from_flat([float(number) for number in text.split()])


def _numbers(text: str) -> list[float] | None:
    """Read what a text lists; None where it lists anything but numbers."""
    try:
        return [float(word) for word in SEPARATORS.split(text) if word]
    except ValueError:
        return None


def _content(name: str) -> str:
    try:
        with Path(name).open(encoding="utf-8") as file:
            return file.read(MOST_CHARACTERS)
    except (OSError, ValueError) as error:
        raise ValueError(f"{name!r} is not {FORM}: {error}") from None
