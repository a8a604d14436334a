"""The take that is being recorded: stores the frames, counts along, and marks the examples in the end."""

from dataclasses import dataclass, replace

from actum.commands import Refusal
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.messages import MANUAL, Segment, Skeleton, TakeState, segment_marks
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum.stamps import Order, StampGuard
from actum_examples.cutting.counting import LAST_REST_S, NOBODY, RepetitionCounter
from actum_examples.marking import Marking, marking_of
from actum_examples.take import OF_THE_TAKE

LONGEST_S = 600.0
"""Longest take (s): forty repetitions with pauses, and what a page can show."""
MOST_FRAMES = 36_000
"""Most frames of a take: so long at 60 a second."""
MOST_MARKED = 500
"""Most segments that somebody marks in a take: one a second."""
LONGEST_NAME = 50
"""Characters of a segment's name that a refusal quotes."""
NOT_KEPT = "nothing was kept: {}, and record the action again"
BEGUN_ANEW = "the sensor restarted during the recording, so the recording was discarded: record again"
JUMPED = "the sensor's time stamps jumped by {:.0f} s, so nothing was kept: check the sensor's clock, and record again"


@dataclass(frozen=True)
class Marked:
    """A segment that somebody marks while a take is recorded."""

    segment_id: str
    agent: int | None
    start_ns: int
    end_ns: int | None = None


class TakeInProgress:
    """Takes skeletons and marks, and shows how far the take is.

    Where somebody marks segments meanwhile, these are the examples; else those that are cut out.
    """

    def __init__(self, recorder: Recorder, state: TakeState, agent: int | None) -> None:
        self.recorder = recorder
        self.state = state
        self._counter = RepetitionCounter(max(state.asked, 1), agent)
        self._marked: dict[str, Marked] = {}
        self._refused, self._refusal = 0, ""
        self._order = StampGuard()
        self._newest_ns = 0
        self._frames = 0

    def skeleton(self, skeleton: Skeleton) -> None:
        """Store a frame and count along; one that is no newer than the one before it is left out.

        Raises:
            Refusal: the sensor's clock has begun anew, or leaps.
            OSError: it cannot be stored.
        """
        order = self._order.judge(skeleton.stamp_ns, skeleton.session_id)
        if order is Order.RESTART:
            raise Refusal(BEGUN_ANEW)
        if order is Order.STALE:
            return
        if self._counter.first_ns is None:
            self._newest_ns = skeleton.stamp_ns
        passed_s = (skeleton.stamp_ns - self._newest_ns) / SECOND_NS
        if passed_s > LONGEST_S:
            raise Refusal(JUMPED.format(passed_s))
        self._newest_ns = skeleton.stamp_ns
        self._frames += 1
        self.recorder.write(skeleton)
        self._counter.receive(skeleton)
        assert self._counter.first_ns is not None
        update = {
            "seconds": (self._newest_ns - self._counter.first_ns) / SECOND_NS,
            "people": len(skeleton.agents),
            "counted": self._counted(),
            "phase": self._counter.phase,
        }
        self.state = self.state.model_copy(update=update)

    def mark(self, mark: Segment) -> str | None:
        """Take somebody's mark; one without a stamp is put at the newest frame. Return why it is refused, if it is."""
        if mark.origin not in (None, MANUAL) or self.state.kind == "background":
            return None
        stamp_ns = self._newest_ns if mark.stamp_ns is None else mark.stamp_ns
        refusal = self._refusal_of(mark, stamp_ns)
        if refusal is not None:
            self._refused, self._refusal = self._refused + 1, refusal
            return refusal
        begun = self._marked.get(mark.segment_id)
        if begun is None:
            self._marked[mark.segment_id] = Marked(mark.segment_id, mark.agent, stamp_ns)
        elif mark.kind == "end" and begun.end_ns is None:
            self._marked[mark.segment_id] = replace(begun, end_ns=stamp_ns)
            self.state = self.state.model_copy(update={"counted": self._counted()})
        return None

    def _refusal_of(self, mark: Segment, stamp_ns: int) -> str | None:
        """Return why a mark is refused: none of its frames can be in the take, or it bounds no example."""
        name = f"the {mark.kind} mark of {mark.segment_id[:LONGEST_NAME]!r}"
        first_ns = self._counter.first_ns
        if first_ns is None:
            return f"{name} came before the first frame: wait until a person is in view"
        if not first_ns <= stamp_ns <= self._newest_ns + MAX_SKEW_NS:
            there = f"whose frames last from {first_ns} to {self._newest_ns} ns"
            return f"{name} at {stamp_ns} ns lies outside the take, {there}: use the stamps of its frames"
        begun = self._marked.get(mark.segment_id)
        if mark.kind == "start" or (begun is not None and begun.end_ns is not None):
            return None
        if begun is None:
            return f"{name} has no start mark before it: mark the start first"
        if not begun.start_ns < stamp_ns <= begun.start_ns + MAX_SEGMENT_NS:
            lasts_s, most_s = (stamp_ns - begun.start_ns) / SECOND_NS, MAX_SEGMENT_NS / SECOND_NS
            return f"{name} lies {lasts_s:.1f} s after its start: end it after at most {most_s:.0f} s"
        return None

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
        if self._counter.first_ns is None:
            return Marking(None, {OF_THE_TAKE: [NOT_KEPT.format(NOBODY)]})
        if self.state.kind == "background":
            return Marking(())
        label, sensor, doubts = self.state.label, self._counter.sensor, self._doubts()
        marks = [
            mark
            for each, end_ns in self._ended()
            for mark in segment_marks(each.start_ns, end_ns, sensor, each.segment_id, label, each.agent, origin=MANUAL)
        ]
        if marks:
            return Marking(marks, {OF_THE_TAKE: doubts})
        cuts = self._counter.cuts()
        if cuts is None:
            return Marking(None, {OF_THE_TAKE: [NOT_KEPT.format(self._counter.why_none), *doubts]})
        marking = marking_of(cuts, self.state.asked, label, sensor)
        marking.doubts.setdefault(OF_THE_TAKE, []).extend(doubts)
        return marking

    def _doubts(self) -> list[str]:
        """Return what became of the marks that make no example, in sentences."""
        doubts = []
        if self._refused:
            doubts.append(f"marks that were refused: {self._refused}. The last one: {self._refusal}")
        unended = len(self._marked) - len(self._ended())
        if unended:
            doubts.append(f"marked segments that were left out, because the take has no end mark for them: {unended}")
        return doubts

    def _counted(self) -> int:
        if self._marked:
            return len(self._ended())
        return 0 if self.state.kind == "background" else self._counter.count

    def _ended(self) -> list[tuple[Marked, int]]:
        """List the marked segments that have an end and frames, with their end (ns), at the latest the take's."""
        return [
            (each, min(each.end_ns, self._newest_ns))
            for each in self._marked.values()
            if each.end_ns is not None and each.start_ns < self._newest_ns
        ]
