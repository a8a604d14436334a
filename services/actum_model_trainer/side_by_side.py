"""Runs independent parts of a training in parallel threads: NumPy and BLAS compute without Python's lock.

Each part computes what it would alone, with one thread of BLAS, so that the model does not depend on the processors.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from actum_model_trainer.progress import Progress, silent

Item = TypeVar("Item")
Result = TypeVar("Result")

_JOBS: ContextVar[int | None] = ContextVar("jobs", default=None)
"""How many parts may run at the same time; None for as many as there are processors to use."""


@contextmanager
def at_most(jobs: int | None) -> Iterator[None]:
    """Let no more parts than these run at the same time; as many as there are processors to use where it is None."""
    before = _JOBS.set(jobs)
    try:
        yield
    finally:
        _JOBS.reset(before)


def side_by_side(
    work: Callable[[Item], Result], items: Sequence[Item], stage: str = "", progress: Progress = silent
) -> list[Result]:
    """Return the results of the work on all items, in their order; there are as many threads as `at_most` allows.

    The progress is that of the stage.
    """
    results = []

    def alone(item: Item) -> Result:
        """Work with nothing of its own side by side: all threads are in use already."""
        with at_most(1):
            return work(item)

    with ThreadPoolExecutor(_JOBS.get() or _processors()) as pool:
        progress(stage, 0, len(items))
        for done, result in enumerate(pool.map(alone, items), start=1):
            results.append(result)
            progress(stage, done, len(items))
    return results


def _processors() -> int | None:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
