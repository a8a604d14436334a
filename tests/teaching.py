"""A trainer to be asked, in a folder of its own, without processes: its jobs say what the test wants."""

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from actum.messages import Message, Segment, Skeleton, Training
from actum.node import SECOND_NS, TICK_NS, Tick
from model_trainer.job import Arguments
from model_trainer.job_process import Ended, Progressing
from model_trainer.original_model import OriginalModel
from model_trainer.trainer import ModelTrainer
from people import FRAME_NS
from repeating import GOGGLES, WAVE, Stream, eased, held, moved, rest

WAVES = [moved(eased(42), WAVE)] * 5
GOGGLINGS = [moved(held(60), GOGGLES)] * 5


class ScriptedJob:
    """A job that says what the test wants."""

    def __init__(self, arguments: Arguments) -> None:
        self.arguments = arguments
        self.news: Progressing | Ended | None = None
        self.ended = False

    def look(self) -> Progressing | Ended | None:
        return self.news

    def end(self) -> None:
        self.ended = True


class Teacher:
    """Asks a trainer as a program would, and acts before its camera."""

    def __init__(self, folder: Path, start: Callable[[Arguments], Any] | None = None) -> None:
        self.folder, self.model, self.original = folder, folder / "in-use.npz", folder / "mine" / "model.npz"
        self.jobs: list[ScriptedJob] = []
        self.told: list[Training] = []
        self._stamp_ns = SECOND_NS
        self._ticks = self._starts = self.passed_ns = 0
        self._start = start or self._scripted
        self.begin()

    def begin(self) -> None:
        """Start the trainer anew, some milliseconds after the one before."""
        self._starts += 1
        now_ns = 1_700_000_000 * SECOND_NS + self._starts * 2_000_000
        self.trainer = ModelTrainer(
            self.folder,
            self.model,
            "kinect0",
            self._start,
            lambda: now_ns + self.passed_ns,
            OriginalModel(self.original, self.model),
        )
        self._commands = {command.name: command for command in self.trainer.commands}

    def _scripted(self, arguments: Arguments) -> ScriptedJob:
        self.jobs.append(ScriptedJob(arguments))
        return self.jobs[-1]

    def ask(self, command: str, **fields: Any) -> dict[str, Any]:
        """Ask, with fields and reply that went through JSON."""
        return json.loads(json.dumps(self._commands[command].obey(json.loads(json.dumps(fields)))))

    def examples(self, name: str = "kitchen") -> list[dict[str, Any]]:
        return self.ask("examples", set=name)["examples"]

    def see(self, messages: Iterable[Message]) -> None:
        """Let it see frames and marks, with ticks between."""
        for message in messages:
            self.trainer.handle(message)
            if isinstance(message, Skeleton):
                self._stamp_ns = message.stamp_ns
                self.tick(1, FRAME_NS)

    def tick(self, ticks: int = 2, interval_ns: int = TICK_NS) -> Training:
        for _ in range(ticks):
            self._ticks += interval_ns
            self.told += self.trainer.handle(Tick(self._ticks))
        return self.told[-1]

    def act(self, stream: Stream) -> None:
        self.see(stream.skeletons(first_ns=self._stamp_ns + SECOND_NS))

    def teach(self, label: str, parts: Sequence[Any], person: str = "anna", name: str = "kitchen") -> None:
        """Record one action after whose last repetition the take ends by itself."""
        self.ask("record", set=name, label=label, person=person, count=len(parts))
        self.act(Stream().repeat(parts).then(rest(4)))


def mark(kind: str, segment_id: str, stamp_ns: int | None = None, origin: str | None = "manual") -> Segment:
    return Segment.model_validate(
        {"stamp_ns": stamp_ns, "sensor": "kinect0", "kind": kind, "segment_id": segment_id, "origin": origin}
    )
