"""The trainer's node: takes frames and marks while somebody teaches, answers commands, and says what it does."""

import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from actum import keys
from actum.atomic_file import PRIVATE_FOLDER
from actum.commands import Command, NoFields
from actum.messages import Message, Segment, Skeleton, Training
from actum.node import SECOND_NS, Counters, Tick
from model_trainer.changes import Changes, refusing
from model_trainer.correction_commands import CorrectionCommands
from model_trainer.example_commands import ExampleCommands
from model_trainer.job_commands import JobCommands, Start
from model_trainer.job_process import JobProcess
from model_trainer.job_store import JobStore
from model_trainer.model_commands import ModelCommands
from model_trainer.model_store import ModelStore
from model_trainer.original_model import OriginalModel
from model_trainer.replies import State
from model_trainer.set_commands import SetCommands
from model_trainer.set_store import SetStore, date_of
from model_trainer.settings import MODEL, Settings
from model_trainer.take_commands import TakeCommands
from model_trainer.upload_store import UploadStore

PUBLISH_NS = SECOND_NS // 5
"""Shortest time between two messages (ns): a page that counts along needs no more."""
REPEAT_NS = SECOND_NS
"""Longest time between two messages (ns): who comes late waits no longer."""
LOOK_NS = SECOND_NS
"""Interval (ns) at which it is looked whether somebody else has replaced the model in use, or changed a set."""


class ModelTrainer:
    """Records takes, keeps sets of them, runs jobs, and puts models into use."""

    name = "model_trainer"
    inputs = (keys.SKELETON, keys.SEGMENT)

    def __init__(
        self,
        folder: Path,
        model: Path,
        sensor: str,
        start: Start,
        now_ns: Callable[[], int],
        original: OriginalModel | None = None,
    ) -> None:
        self.counters = Counters()
        self._original = original
        self._copy_original()
        self._sensor = sensor
        self._changes = Changes(now_ns())
        sets = self._sets = SetStore(folder / "sets", now_ns)
        self._models = ModelStore(folder / "models", model, folder / MODEL, now_ns)
        self._examples = ExampleCommands(sets, self._models, self._changes)
        self._takes = TakeCommands(sets, self._changes, self._examples.remove)
        self._corrections = CorrectionCommands(sets, self._changes)
        self._jobs = JobCommands(
            sets,
            self._models,
            UploadStore(folder / "uploads"),
            JobStore(folder / "jobs"),
            self._changes,
            start,
            lambda: date_of(now_ns()),
        )
        self._set_commands = SetCommands(sets, self._models, self._changes, self._takes, self._jobs, self.counters)
        self._model_commands = ModelCommands(self._models, self._changes)
        self._newest_ns = 0
        self._looked_revision = self._changes.revision
        self._published: Training | None = None
        self._published_ns = self._looked_ns = 0

    @classmethod
    def configured(cls, settings: Settings) -> "ModelTrainer":
        """Build the node as the settings say.

        Raises:
            ValueError: its folder cannot be written to.
        """
        folder = settings.trainer_data
        try:
            folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
            model = settings.model or folder / MODEL
            original = OriginalModel(settings.original_model, model) if settings.original_model else None
            return cls(folder, model, settings.sensor, JobProcess, time.time_ns, original)
        except OSError as error:
            raise ValueError(
                f"the folder {folder} for sets and models cannot be used ({error}): set ACTUM_TRAINER_DATA to another "
                "folder"
            ) from None

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        recording = self._takes, self._corrections, self._examples
        groups = (self._set_commands, *recording, self._jobs, self._model_commands)
        own = Command("state", NoFields, State, self._describe)
        return (own, *(refusing(command) for group in groups for command in group.commands))

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Receive a frame or a mark of the take that is recorded, or a tick; return what has changed, on ticks."""
        match message:
            case Skeleton() | Segment():
                if isinstance(message, Skeleton):
                    self._newest_ns = message.stamp_ns
                    self._corrections.receive(message)
                self._takes.receive(message, self.counters)
                return []
            case Tick():
                return self._tick(message.monotonic_ns)
            case _:
                return []

    def _tick(self, now_ns: int) -> list[Message]:
        self._jobs.look()
        if abs(now_ns - self._looked_ns) >= LOOK_NS:
            self._looked_ns = now_ns
            self._look_at_files()
        state = self._state()
        if self._published is not None:
            changed = state != self._published.model_copy(update={"stamp_ns": state.stamp_ns})
            if abs(now_ns - self._published_ns) < (PUBLISH_NS if changed else REPEAT_NS):
                return []
        self._published, self._published_ns = state, now_ns
        return [state]

    def _look_at_files(self) -> None:
        try:
            self._copy_original()
            self._changes.revision += self._models.look()
            is_others = self._sets.look() and self._changes.revision == self._looked_revision
            self._changes.revision += is_others  # changes of our own are counted already
            self._looked_revision = self._changes.revision
        except OSError as error:
            self.counters.reject("lost_model", f"no copy of the model in use could be kept: {error}")
        if self._original is not None:
            self.counters.state = self._original.state(self._models.active is not None)

    def _copy_original(self) -> None:
        """Put the user's own model file into use where it has changed."""
        if self._original is not None and (problem := self._original.copy_changed()) is not None:
            self.counters.reject("bad_model", problem)

    def _describe(self, _: NoFields) -> State:
        """Return what is recorded, which job runs, and which model is in use."""
        return State.model_validate(self._state().model_dump(include=set(State.model_fields)))

    def _state(self) -> Training:
        return Training(
            stamp_ns=self._newest_ns,
            sensor=self._sensor,
            recording=self._takes.state,
            job=self._jobs.state,
            model=self._models.active,
            can_undo=bool(self._models.before),
            revision=self._changes.revision,
            model_set=self._models.set,
            model_file=None if self._original is None else self._original.source_of(self._models.active),
        )
