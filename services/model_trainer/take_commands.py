"""The commands that record takes."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from pydantic import ValidationError

from actum.codec import encodable
from actum.commands import Command, NoFields, Refusal, problems
from actum.messages import Segment, Skeleton, TakeState
from actum.node import Counters
from actum.recording import RecordingError
from actum_examples.cutting.choice import MOST_REPETITIONS
from actum_examples.marked_segment import MarkedSegment
from actum_examples.marking import finish_take
from actum_examples.take import OF_THE_TAKE, Take
from actum_examples.take_in_progress import TakeInProgress
from model_trainer.changes import Changes
from model_trainer.correction_commands import is_correction
from model_trainer.replies import Done, TakeReply
from model_trainer.requests import OfSet, Record
from model_trainer.set_store import SetStore, take_number

LOSING = (OSError, RecordingError, Refusal)
"""What is raised where a take is lost: it cannot be stored, its set is gone, or the sensor has begun anew."""
LONGEST_DOUBT = 1000
"""Characters of a doubt that are published."""
Remove = Callable[[Take, list[MarkedSegment]], None]
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
        self._replaced: str | None = None

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
        """Return whether a take of that set is being recorded."""
        return self._take is not None and self._take.state.set == name

    def receive(self, message: Skeleton | Segment, counters: Counters) -> None:
        """Receive a frame or a mark; count a mark that is refused, and the take where it is lost by that."""
        take = self._take
        if take is None:
            return
        try:
            if isinstance(message, Skeleton):
                take.skeleton(message)
            elif (refusal := take.mark(message)) is not None:
                counters.reject("refused_mark", refusal)
            self.state = take.state
            if take.over:
                self._finish()
        except LOSING as error:
            self._give_up()
            lost = {"phase": "done", "counted": 0, "doubts": [encodable(str(error))[:LONGEST_DOUBT]]}
            self.state = take.state.model_copy(update=lost)
            counters.reject("lost_take", str(error))

    def _record(self, request: Record) -> TakeReply:
        """Begin a take: it counts along, ends by itself after the last repetition, and cuts the examples out."""
        if request.kind == "action" and not request.label:
            raise Refusal(
                "the action has no name: enter a name (label), or record background, that is, people who do none of "
                "the actions"
            )
        self._begin(request)
        return TakeReply(take=None, examples=0, doubts=[])

    def _stop(self, _: NoFields) -> TakeReply:
        """End the take that is being recorded; its examples appear."""
        self._refuse_idle()
        try:
            return self._finish()
        except LOSING as error:
            self._give_up()
            raise Refusal(f"the recording could not be stored and is lost ({error}): record again") from None

    def _discard(self, _: NoFields) -> Done:
        """Drop the take that is being recorded."""
        self._refuse_idle()
        self._give_up()
        return Done(revision=self._changes.revision)

    def _redo_last(self, request: OfSet) -> TakeReply:
        """Record the newest take of a set anew; the old one goes once the new one is there."""
        self._refuse_recording()
        takes = [take for take in self._sets.get(request.set).takes if take.labels and not is_correction(take)]
        if not takes:
            raise Refusal(
                f"the set {request.set} contains no recording of an action yet, so there is nothing to repeat: record "
                "an action first"
            )
        newest = max(takes, key=lambda take: (take_number(take.id), take.created, take.id))
        label, count = newest.labels[-1], min(len(newest.labels), MOST_REPETITIONS)
        try:
            anew = Record(set=request.set, label=label, person=newest.person, count=count)
        except ValidationError as error:
            raise Refusal(
                f"the newest recording {newest.id} cannot be repeated, because the name of its label or of its person "
                f"is not valid ({problems(error)}): start a new recording with the command 'record'"
            ) from None
        self._begin(anew)
        self._replaced = newest.id
        return TakeReply(take=None, examples=0, doubts=[])

    def _begin(self, request: Record) -> None:
        self._refuse_recording()
        self._sets.folder(request.set)
        background = request.kind == "background"
        state = TakeState(
            set=request.set,
            label=request.label,
            person=request.person,
            kind=request.kind,
            asked=0 if background else request.count,
            counted=0,
            phase="waiting",
            seconds=0.0,
        )
        recorder = self._sets.recorder(request.person, request.kind)
        self.state, self._replaced = state, None
        self._take = TakeInProgress(recorder, state, request.agent)

    def _finish(self) -> TakeReply:
        """End the take and move it into its set, unless there is nothing in it.

        Raises:
            OSError, RecordingError, Refusal: it cannot be written.
        """
        take = self._take
        assert take is not None
        marking = take.marking()
        doubts = list(marking.doubts.get(OF_THE_TAKE, []))
        if marking.marks is None:
            self._give_up()
            name, examples = None, 0
        else:
            added = self._sets.add(take.state.set, finish_take(take.recorder, marking))
            self._take = None
            self._changes.revision += 1
            name, examples = added.id, len(added.examples)
            doubts += self._remove_replaced(take.state.set) if examples and self._replaced is not None else []
        doubts = [doubt[:LONGEST_DOUBT] for doubt in doubts]
        self.state = take.state.model_copy(update={"phase": "done", "counted": examples, "doubts": doubts})
        return TakeReply(take=name, examples=examples, doubts=doubts)

    def _remove_replaced(self, name: str) -> list[str]:
        """Delete the take that was recorded anew, if it is still there; return why it stays where it has to."""
        try:
            for take in self._sets.get(name).takes:
                if take.id == self._replaced:
                    self._remove(take, take.examples)
        except LOSING as error:
            return [f"the old recording {self._replaced} could not be deleted: {encodable(str(error))}"]
        return []

    def _give_up(self) -> None:
        """Drop the take; what of its file cannot be deleted goes with the next start."""
        assert self._take is not None
        take, self._take, self.state = self._take, None, None
        with suppress(OSError):
            take.recorder.discard()

    def _refuse_idle(self) -> None:
        if self._take is None:
            raise Refusal("no recording is running: start a recording first")

    def _refuse_recording(self) -> None:
        if self._take is not None:
            raise Refusal(
                f"a recording into the set {self._take.state.set} is running: stop or discard this recording first"
            )
