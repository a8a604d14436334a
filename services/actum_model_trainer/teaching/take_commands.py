"""The commands that record takes."""

from collections.abc import Callable
from typing import Any

from actum.commands import Command, NoFields, Refusal
from actum.messages import Segment, Skeleton, TakeState
from actum_model_trainer.teaching.changes import Changes, on_disk
from actum_model_trainer.teaching.replies import Done, TakeReply
from actum_model_trainer.teaching.requests import OfSet, Record
from actum_model_trainer.teaching.set_store import SetStore
from actum_model_trainer.teaching.take_files import OF_THE_TAKE, Example, Take, finish_take
from actum_model_trainer.teaching.take_in_progress import TakeInProgress

Remove = Callable[[Take, list[Example]], None]
"""Takes examples out of a take, and deletes one that has none left."""


class TakeCommands:
    """Records one take at a time.

    Attributes:
        state: of the take that is being recorded, or of the newest one; None before the first.
    """

    def __init__(self, sets: SetStore, changes: Changes, remove: Remove) -> None:
        self.state: TakeState | None = None
        self._sets = sets
        self._changes = changes
        self._remove = remove
        self._take: TakeInProgress | None = None

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (
            Command("record", Record, TakeReply, self._record),
            Command("stop", NoFields, TakeReply, self._stop),
            Command("discard", NoFields, Done, self._discard),
            Command("redo_last", OfSet, TakeReply, self._redo_last),
        )

    def recording_to(self, name: str) -> bool:
        """Tell whether a take of that set is being recorded."""
        return self._take is not None and self._take.state.set == name

    def take(self, message: Skeleton | Segment) -> str | None:
        """Take a frame or a mark; return why the take that was being recorded was lost, if it was."""
        if self._take is None:
            return None
        try:
            if isinstance(message, Skeleton):
                self._take.skeleton(message)
            else:
                self._take.mark(message)
            self.state = self._take.state
            if self._take.over:
                self._finish()
        except (OSError, Refusal) as error:
            state = self._take.state
            self._give_up()
            self.state = state.model_copy(update={"phase": "done", "counted": 0, "doubts": [str(error)]})
            return str(error)
        return None

    def _record(self, request: Record) -> TakeReply:
        """Begin a take: it counts along, ends by itself after the last repetition, and cuts the examples out."""
        if request.kind == "action" and not request.label:
            raise Refusal("what is done? Give a label, or record background")
        self._begin(request)
        return TakeReply(take=None, examples=0, doubts=[])

    def _stop(self, _: NoFields) -> TakeReply:
        """End the take that is being recorded; its examples appear."""
        self._refuse_idle()
        try:
            return self._finish()
        except OSError as error:
            self._give_up()
            raise Refusal(f"the take is lost: {error}") from None

    def _discard(self, _: NoFields) -> Done:
        """Drop the take that is being recorded."""
        self._refuse_idle()
        self._give_up()
        return Done(revision=self._changes.revision)

    def _redo_last(self, request: OfSet) -> TakeReply:
        """Drop the newest example of a set, and record one in its place."""
        self._refuse_recording()
        takes = [take for take in self._sets.get(request.set).takes if take.examples]
        if not takes:
            raise Refusal(f"{request.set} has no example yet: record some")
        newest = max(takes, key=lambda take: (take.created, take.id))
        example = newest.examples[-1]
        with self._changes.change():
            self._remove(newest, [example])
        self._begin(Record(set=request.set, label=example.label, person=newest.person, count=1))
        return TakeReply(take=None, examples=0, doubts=[])

    def _begin(self, request: Record) -> None:
        self._refuse_recording()
        self._sets.folder(request.set)
        background = request.kind == "background"
        self.state = TakeState(
            set=request.set,
            label=request.label,
            person=request.person,
            kind=request.kind,
            asked=0 if background else request.count,
            counted=0,
            phase="waiting",
            seconds=0.0,
        )
        with on_disk():
            recorder = self._sets.recorder(request.person, request.kind)
        self._take = TakeInProgress(recorder, self.state, request.agent)

    def _finish(self) -> TakeReply:
        """End the take and move it into its set, unless there is nothing in it.

        Raises:
            OSError, Refusal: it cannot be written.
        """
        take = self._take
        assert take is not None
        marking = take.marking()
        doubts = marking.doubts.get(OF_THE_TAKE, [])
        if marking.marks is None:
            take.recorder.discard()
            name, examples = None, 0
        else:
            added = self._sets.add(take.state.set, finish_take(take.recorder, marking.marks, marking.doubts))
            self._changes.revision += 1
            name, examples = added.id, len(added.examples)
        self._take = None
        self.state = take.state.model_copy(update={"phase": "done", "counted": examples, "doubts": doubts})
        return TakeReply(take=name, examples=examples, doubts=doubts)

    def _give_up(self) -> None:
        """Drop the take."""
        assert self._take is not None
        self._take.recorder.discard()
        self._take = self.state = None

    def _refuse_idle(self) -> None:
        if self._take is None:
            raise Refusal("nothing is being recorded: begin with 'record'")

    def _refuse_recording(self) -> None:
        if self._take is not None:
            raise Refusal(f"a take of {self._take.state.set} is being recorded: 'stop' or 'discard' it first")
