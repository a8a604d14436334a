"""How long work tells how far it is."""

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called with the stage, and how much of it is done out of how much."""


def silent(stage: str, done: int, total: int) -> None:
    """Report nothing."""
