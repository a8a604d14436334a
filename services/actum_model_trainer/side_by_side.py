"""Runs independent parts of a training in parallel threads: NumPy and BLAS compute without Python's lock.

Each part computes what it would alone, with one thread of BLAS, so that the model does not depend on the processors.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from actum_model_trainer.progress import Progress, silent

Item = TypeVar("Item")
Result = TypeVar("Result")


def side_by_side(
    work: Callable[[Item], Result], items: Sequence[Item], stage: str = "", progress: Progress = silent
) -> list[Result]:
    """Return the results of the work on all items, in their order; there are as many threads as processors to use.

    The progress is that of the stage.
    """
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    results = []
    with ThreadPoolExecutor(processors) as pool:
        progress(stage, 0, len(items))
        for done, result in enumerate(pool.map(work, items), start=1):
            results.append(result)
            progress(stage, done, len(items))
    return results
