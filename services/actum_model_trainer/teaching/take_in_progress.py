"""The take that is being recorded: stores the frames, counts along, and marks the examples in the end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from actum.commands import Refusal
from actum.messages import MANUAL, Segment, Skeleton, TakeState, segment_marks
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum_model_trainer.cutting.counting import LAST_REST_S, RepetitionCounter
from actum_model_trainer.teaching.take_files import OF_THE_TAKE, cut_marks

LONGEST_S = 600.0
"""Longest take (s): forty repetitions with pauses, and what a page can show."""
MOST_FRAMES = 36_000
"""Most frames of a take: so long at 60 a second."""
MOST_MARKED = 500
"""Most segments that somebody marks in a take: one a second."""
NOBODY = "nobody was seen moving, so nothing was kept"
BEGUN_ANEW = "the sensor has begun anew meanwhile, so nothing was kept: record it again"
EMPTY = "nobody was seen, so nothing was kept"


@dataclass(frozen=True)
class Marked:
    """A segment that somebody marks while a take is recorded."""

    segment_id: str
    agent: int | None
    start_ns: int
    end_ns: int | None = None


@dataclass(frozen=True)
class Marking:
    """The marks of a take that has ended, and what may be wrong with them by segment id; None where none is kept."""

    marks: Sequence[Segment] | None
    doubts: dict[str, list[str]]


class TakeInProgress:
    """Takes skeletons and marks, and tells how far the take is.

    Where somebody marks segments meanwhile, these are the examples; else those that are cut out.
    """

    def __init__(self, recorder: Recorder, state: TakeState, agent: int | None) -> None:
        self.recorder = recorder
        self.state = state
        self._counter = RepetitionCounter(max(state.asked, 1), agent)
        self._marked: dict[str, Marked] = {}
        self._sensor = self._session_id = ""
        self._first_ns: int | None = None
        self._newest_ns = 0
        self._frames = 0

    def skeleton(self, skeleton: Skeleton) -> None:
        """Store a frame and count along; one that is no newer than the one before it is left out.

        Raises:
            Refusal: the sensor's clock has begun anew.
            OSError: it cannot be stored.
        """
        if self._first_ns is None:
            self._first_ns, self._session_id = skeleton.stamp_ns, skeleton.session_id
        elif skeleton.session_id != self._session_id:
            raise Refusal(BEGUN_ANEW)
        elif skeleton.stamp_ns <= self._newest_ns:
            return
        self._sensor, self._newest_ns = skeleton.sensor, skeleton.stamp_ns
        self._frames += 1
        self.recorder.write(skeleton)
        self._counter.take(skeleton)
        update = {
            "seconds": (self._newest_ns - self._first_ns) / SECOND_NS,
            "people": len(skeleton.agents),
            "counted": self._counted(),
            "phase": self._counter.phase,
        }
        self.state = self.state.model_copy(update=update)

    def mark(self, mark: Segment) -> None:
        """Take somebody's mark; one without a stamp is put at the newest frame."""
        if mark.origin not in (None, MANUAL) or self._first_ns is None or self.state.kind == "background":
            return
        stamp_ns = self._newest_ns if mark.stamp_ns is None else mark.stamp_ns
        begun = self._marked.get(mark.segment_id)
        if mark.kind == "start" and begun is None:
            self._marked[mark.segment_id] = Marked(mark.segment_id, mark.agent, stamp_ns)
        elif mark.kind == "end" and begun is not None and begun.end_ns is None and stamp_ns > begun.start_ns:
            self._marked[mark.segment_id] = replace(begun, end_ns=stamp_ns)
            self.state = self.state.model_copy(update={"counted": self._counted()})

    @property
    def over(self) -> bool:
        """Whether it ends by itself now: all repetitions are done and a long rest follows, or it gets too long."""
        if self.state.seconds > LONGEST_S or self._frames >= MOST_FRAMES or len(self._marked) >= MOST_MARKED:
            return True
        if self.state.kind == "background":
            return False
        if not self._marked:
            return self._counter.finished
        ended_ns = max((each.end_ns or self._newest_ns for each in self._marked.values()), default=0)
        return self.state.counted >= self.state.asked and self._newest_ns - ended_ns > LAST_REST_S * SECOND_NS

    def marking(self) -> Marking:
        """Mark the examples."""
        if self._first_ns is None:
            return Marking(None, {OF_THE_TAKE: [EMPTY]})
        if self.state.kind == "background":
            return Marking((), {})
        ended = self._ended()
        if ended:
            return Marking([mark for each in ended for mark in self._marks_of(each)], {})
        cuts = self._counter.cuts()
        if cuts is None:
            return Marking(None, {OF_THE_TAKE: [NOBODY]})
        return Marking(*cut_marks(cuts, self.state.label, self._sensor))

    def _counted(self) -> int:
        return len(self._ended()) if self._marked else min(self._counter.count, self.state.asked)

    def _ended(self) -> list[Marked]:
        return [each for each in self._marked.values() if each.end_ns is not None]

    def _marks_of(self, marked: Marked) -> list[Segment]:
        assert marked.end_ns is not None
        return segment_marks(
            marked.start_ns,
            marked.end_ns,
            self._sensor,
            marked.segment_id,
            self.state.label,
            marked.agent,
            origin=MANUAL,
        )
