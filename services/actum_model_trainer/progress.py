"""How long-running work reports its progress."""

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called with the name of the stage, the steps done and the steps in all."""


def silent(stage: str, done: int, total: int) -> None:
    """Report nothing."""


def prefixed(prefix: str, progress: Progress) -> Progress:
    """Return a progress that names each stage with a prefix."""
    return lambda stage, done, total: progress(prefix + stage, done, total)
