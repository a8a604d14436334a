"""The command that makes an example, or a counterexample, of what the classifier found."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from actum.commands import Command, Refusal
from actum.limits import MAX_SEGMENT_NS
from actum.messages import MANUAL, NONE, Skeleton, segment_marks
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum_examples.marking import Marking, finish_take
from actum_examples.take import Take
from actum_model_trainer.background import FEWEST_FRAMES
from model_trainer.changes import Changes, on_disk
from model_trainer.recent_frames import LONGEST_S, RecentFrames
from model_trainer.replies import TakeReply
from model_trainer.requests import Correct
from model_trainer.set_store import SetStore

NAME = "corrected-1"
"""The segment of a correction, in its take of its own."""


class CorrectionCommands:
    """Says what was really done in an event that was told wrongly, or held back wrongly."""

    def __init__(self, sets: SetStore, changes: Changes) -> None:
        self._sets = sets
        self._changes = changes
        self._recent = RecentFrames()

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """What can be asked."""
        return (Command("correct", Correct, TakeReply, self._correct),)

    def receive(self, skeleton: Skeleton) -> None:
        """Keep a frame: somebody may say of it later what was done."""
        self._recent.receive(skeleton)

    def _correct(self, request: Correct) -> TakeReply:
        """Add an event of the last ten minutes to a set: as an example of an action, or as none of the actions."""
        if not 0 < request.end_ns - request.start_ns <= MAX_SEGMENT_NS:
            raise Refusal(
                f"end_ns has to be later than start_ns, but by at most {MAX_SEGMENT_NS // SECOND_NS} s: copy both "
                "values from one message, either an event or a held_back message"
            )
        self._sets.folder(request.set)
        frames = list(self._recent.of(request.agent, request.start_ns, request.end_ns))
        if len(frames) < FEWEST_FRAMES:
            raise Refusal(
                f"this event can no longer be corrected, because only {len(frames)} frames of person {request.agent} "
                f"are still stored, and at least {FEWEST_FRAMES} are needed. Frames are kept for {LONGEST_S / 60:.0f} "
                "minutes, and are lost when the sensor or the trainer restarts"
            )
        first, last = frames[0], frames[-1]
        label = request.label or NONE
        marks = segment_marks(first.stamp_ns, last.stamp_ns, first.sensor, NAME, label, request.agent, origin=MANUAL)
        self._refuse_again(request, (first.stamp_ns, last.stamp_ns))
        with on_disk(), discarding_on_error(self._sets.recorder(request.person, "action")) as recorder:
            for frame in frames:
                recorder.write(frame)
            take = self._sets.add(request.set, finish_take(recorder, Marking(marks)))
        self._changes.revision += 1
        return TakeReply(take=take.id, examples=len(take.examples), doubts=[])

    def _refuse_again(self, request: Correct, bounds_ns: tuple[int, int]) -> None:
        for take in self._sets.get(request.set).takes:
            for each in take.examples if is_correction(take) else []:
                if (each.agent, each.bounds_ns) == (request.agent, bounds_ns):
                    raise Refusal(
                        f"this event was corrected before, so it is an example of {each.label!r} in the set "
                        f"{request.set}: to correct the event again, first delete that example in the panel 'Teach'"
                    )


def is_correction(take: Take) -> bool:
    """Tell whether a take was made by a correction."""
    return any(each.segment_id == NAME for each in take.examples)


@contextmanager
def discarding_on_error(recorder: Recorder) -> Iterator[Recorder]:
    """Return a context that discards what was recorded where an error ends it."""
    try:
        yield recorder
    except BaseException:
        recorder.discard()
        raise
