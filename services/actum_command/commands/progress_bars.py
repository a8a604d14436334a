"""Progress of long work: bars on a terminal, a line every few seconds elsewhere."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from actum_command.commands.terminal import errors
from actum_model_trainer.progress import Progress as Report

LINE_S = 3.0
"""Interval (s) between two lines, so that a log stays short and nobody takes the work for stuck."""


class Bars:
    """One bar per stage, added at the stage's first report."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._tasks: dict[str, int] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Show how much of a stage is done."""
        if stage not in self._tasks:
            self._tasks[stage] = self._progress.add_task(stage, total=total)
        self._progress.update(self._tasks[stage], completed=done, total=total)  # type: ignore[arg-type]


class Lines:
    """What is done, as a line: in a file or a pipe nothing can be drawn over."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s, self._began_s = now_s, now_s()
        self._newest: tuple[str, int, int] | None = None

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Keep how much of a stage is done."""
        self._newest = stage, done, total

    @property
    def line(self) -> str:
        """The newest stage, how much of it is done, and for how long the work has lasted."""
        stage = "starting" if self._newest is None else "{}: {} of {}".format(*self._newest)
        return f"{stage}, after {self._now_s() - self._began_s:.0f} s"


@contextmanager
def bars() -> Iterator[Report]:
    """Show progress on the error stream while the work lasts."""
    if errors.is_terminal:
        columns = TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
        with Progress(*columns, console=errors, transient=True) as progress:
            yield Bars(progress)
        return
    lines, over = Lines(), threading.Event()

    def print_now_and_then() -> None:
        while not over.wait(LINE_S):
            errors.print(lines.line, markup=False, soft_wrap=True)

    printing = threading.Thread(target=print_now_and_then, daemon=True)
    printing.start()
    try:
        yield lines
    finally:
        over.set()
        printing.join()
