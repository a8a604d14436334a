"""Which known word may be meant by one that is none."""

from collections.abc import Iterable
from difflib import get_close_matches

ALIKE = 0.75
"""Least similarity (0 to 1, difflib's ratio): two letters changed places in a word of five has 0.8."""


def nearest(word: str, known: Iterable[str]) -> list[str]:
    """Return the known word that is most like a word, or the one that begins with it; nothing where none does."""
    words = list(known)
    begun = [each for each in words if len(word) > 1 and each.startswith(word)]
    return get_close_matches(word, words, n=1, cutoff=ALIKE) or begun[:1]
