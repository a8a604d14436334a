"""Somebody who teaches on the page: the page's service and the trainer in one process, without a router."""

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from actum import __version__
from actum.commands import Command, Refusal
from actum.messages import Info, Message, Segment, Skeleton
from dashboards import Colleague, Served, served
from model_trainer.job_process import Ended
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model
from teaching import Teacher

TICK_S = 0.05
"""How often the trainer gets time (s)."""
SET = "kitchen"


class Lesson:
    """A page, its trainer, and a preprocessor whose parameters can be changed."""

    def __init__(self, page: Served, teacher: Teacher, colleague: "Class") -> None:
        self.page = page
        self.teacher = teacher
        self.put_messages = colleague.put_messages
        self._lock = colleague.lock

    def see(self, messages: Iterable[Message]) -> None:
        """Let the trainer and the page see frames."""
        for message in messages:
            with self._lock:
                self.teacher.see([message])
            if isinstance(message, Skeleton):
                self.page.give(message)

    def end_job(self, result: dict[str, Any] | None, error: str = "") -> None:
        """End the running job; one that trains leaves a model."""
        with self._lock:
            job = self.teacher.jobs[-1]
            if job.arguments.kind == "train" and result is not None:
                tiny_model().save(job.arguments.folder / "model.npz")
            job.news = Ended(result, error)

    def tell(self) -> None:
        """Give the trainer a tick, and the page what it says."""
        with self._lock:
            before = len(self.teacher.told)
            self.teacher.tick(1)
            told = self.teacher.told[before:]
        self.page.give(*told)


class Class(Colleague):
    """In the place of a client: asks the trainer and the preprocessor, and passes on marks."""

    def __init__(self, teacher: Teacher) -> None:
        super().__init__(self._asked)
        self.lock = threading.Lock()
        self._teacher = teacher
        self._commands: dict[str, Command[Any, Any]] = {
            command.name: command for command in PosePreprocessor(PoseSettings.defaults()).commands
        }
        self.performed: list[dict[str, Any]] = []

    def put(self, message: Message) -> None:
        super().put(message)
        if isinstance(message, Segment):
            with self.lock:
                self._teacher.see([message])

    def infos(self) -> list[Message]:
        offered = {"pose_preprocessor": sorted(self._commands), "sensor_gateway": ["perform", "repertoire"]}
        return [
            Info(
                stamp_ns=1, sensor="kinect0", service=service, instance="x", version=__version__, schemas=[],
                joint_names=[], commands=commands,
            )
            for service, commands in offered.items()
        ]  # fmt: skip

    def _asked(self, service: str, command: str, **fields: Any) -> dict[str, Any]:
        with self.lock:
            if service == "model_trainer":
                return self._teacher.ask(command, **fields)
            if service == "pose_preprocessor":
                return self._commands[command].obey(fields)
        if service == "sensor_gateway":
            if command == "repertoire":
                return {"actions": ["push", "lift"]}
            self.performed.append(fields)
            return {"waiting": 1}
        raise Refusal(f"{service} is not in this room")


@contextmanager
def lesson(folder: Path) -> Iterator[Lesson]:
    """Serve a page for a trainer in a folder, which is told all the time."""
    teacher = Teacher(folder)
    colleague, stop = Class(teacher), threading.Event()
    with served(colleague) as page:
        made = Lesson(page, teacher, colleague)

        def tick() -> None:
            while not stop.wait(TICK_S):
                made.tell()

        thread = threading.Thread(target=tick, daemon=True)
        thread.start()
        try:
            yield made
        finally:
            stop.set()
            thread.join()
            with suppress(Refusal):  # nothing is recorded
                teacher.ask("discard")
