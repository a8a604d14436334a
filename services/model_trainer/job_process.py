"""Runs a job as a process of its own, so that it disturbs no service and can be ended at any time."""

import json
import os
import subprocess
import sys
import threading
from dataclasses import dataclass
from typing import Any

from actum.atomic_file import claim
from actum.runtime.stopping import PARENT
from model_trainer.job import Arguments

END_S = 2.0
"""How long (s) a job may take to end after SIGTERM, before it is killed."""
FORMS = ({"stage", "done"}, {"result"}, {"error"})
"""The fields of a job's lines."""
CLAIM = ".running"
"""The file in a job's folder that its service has claimed while the job runs."""
LAST_WORDS = 400
"""Characters of what a job printed at the end, for one that died."""


@dataclass(frozen=True)
class Progressing:
    """How far a job is: the stage, and how much of it is done, 0 to 1."""

    stage: str
    done: float


@dataclass(frozen=True)
class Ended:
    """How a job ended: with a result, or with the reason for which there is none."""

    result: dict[str, Any] | None
    error: str = ""


class JobProcess:
    """A running job: `python -m model_trainer.job`, which prints its progress as lines of JSON."""

    def __init__(self, arguments: Arguments) -> None:
        self._errors = arguments.folder / "errors.txt"
        self._claimed = (arguments.folder / CLAIM).open("wb")
        claim(self._claimed)
        with self._errors.open("wb") as errors:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "model_trainer.job", arguments.model_dump_json()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=errors,
                env={**os.environ, PARENT: str(os.getpid())},
            )
        self._newest: dict[str, Any] = {}
        self._reading = threading.Thread(target=self._read, daemon=True)
        self._reading.start()

    def look(self) -> Progressing | Ended | None:
        """Return how far it is, or how it ended; None before it has said anything."""
        ended = self._process.poll() is not None and not self._reading.is_alive()
        newest = self._newest
        if "result" in newest or "error" in newest:
            return Ended(newest.get("result"), newest.get("error", "")) if ended else None
        if ended:
            code = self._process.returncode
            how = f"signal {-code}" if code < 0 else f"exit code {code}"
            return Ended(None, f"its process ended unexpectedly ({how}): {self._last_words()}")
        return Progressing(newest["stage"], newest["done"]) if newest else None

    def end(self) -> None:
        """End it, whatever it does."""
        self._process.terminate()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._claimed, self._process.stdout as lines:
            for line in lines:
                try:
                    printed = json.loads(line, parse_constant=lambda _: None)  # no number: no reply can hold it
                except (ValueError, RecursionError):
                    continue  # what a library prints
                if isinstance(printed, dict) and printed.keys() in FORMS:
                    self._newest = printed

    def _last_words(self) -> str:
        try:
            words = self._errors.read_text(errors="replace").strip()[-LAST_WORDS:]
        except OSError as error:
            return f"what it printed cannot be read ({error.strerror})"
        return words or "it printed nothing"
