"""Finds the stamps of marks that have none: those of their segment's final answer, wherever its name comes again."""

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass

from actum.limits import MAX_SKEW_NS
from actum.messages import Action, Segment
from actum.node import SETTLE_NS

MOST_MARKS = 1000
"""Most marks that are kept, each the newest of its kind and segment."""
MOST_ANSWERED = 256
"""Most answers that are kept, for marks that come after them and to know them where they come again."""


@dataclass
class Bounds:
    """A segment's bounds as it was answered, the tick of the answer, and the kinds of its marks that have not come."""

    start_ns: int
    end_ns: int | None
    since_ns: int
    lacks: set[str]

    def stamp_ns(self, mark: Segment) -> int | None:
        """Return the stamp of a mark of the segment, None where the answer has no end."""
        return self.start_ns if mark.kind == "start" else self.end_ns


@dataclass(frozen=True)
class Pending:
    """A mark, since when it waits (ns), the newest frame's stamp then, and the bounds that may be its own."""

    mark: Segment
    since_ns: int
    newest_ns: int | None
    late_for: Bounds | None = None

    @property
    def due_ns(self) -> int:
        """Until when an answer of its own may come."""
        return self.since_ns + (SETTLE_NS if self.late_for is None else MAX_SKEW_NS)

    def placed(self, bounds: Bounds | None) -> "Placed":
        """Return the mark with a stamp, and since when it has waited (ns).

        The stamp is the answer's for this mark, else the newest frame's, else the answer's start.
        """
        answered_ns = None if bounds is None else bounds.stamp_ns(self.mark)
        known_ns = [answered_ns, self.newest_ns, None if bounds is None else bounds.start_ns]
        stamp_ns = next((each for each in known_ns if each is not None), None)
        return self.mark.model_copy(update={"stamp_ns": stamp_ns}), self.since_ns


Placed = tuple[Segment, int]
"""A mark that waits no longer, and since when it has waited (ns); without a stamp where nothing gives it one."""


class UnstampedMarks:
    """Keeps marks without a stamp until their segment is answered. Times are of one clock that never goes back.

    A segment's name is used again after a sensor has begun anew, or by another sensor. So an answer is that of the
    newest start and end mark of its name, each answer places each of the two once, and a repeated answer none. A
    mark that comes up to `MAX_SKEW_NS` after an answer that still lacks it is that segment's, unless another answer
    follows within that time and before the next start mark.
    """

    def __init__(self) -> None:
        self._newest: OrderedDict[tuple[str, str, str], Pending] = OrderedDict()
        self._answered: OrderedDict[tuple[str, str, str, int, int | None], Bounds] = OrderedDict()
        self._due_ns: float = float("inf")

    def receive(self, mark: Segment, now_ns: int, newest_ns: int | None = None) -> Iterator[Placed]:
        """Take a mark, also one that has its stamp and is only noted; yield those that it shows to be of before."""
        late_for = self._lacking(mark, now_ns)
        if mark.stamp_ns is not None and late_for is not None:
            late_for.lacks.discard(mark.kind)
            return
        name, end = (mark.sensor, mark.segment_id, mark.kind), (mark.sensor, mark.segment_id, "end")
        yield from self._settled(name)
        if end in self._newest and self._newest[end].late_for is not None:
            yield from self._settled(end)
        pending = self._newest[name] = Pending(mark, now_ns, newest_ns, late_for)
        self._due_ns = min(self._due_ns, pending.due_ns)
        if len(self._newest) > MOST_MARKS:
            yield from self._settled(next(iter(self._newest)))

    def answer(self, final: Action, now_ns: int) -> Iterator[Placed]:
        """Take a final answer; yield the marks that it places."""
        known = final.sensor, final.segment_id, final.session_id, final.start_ns, final.end_ns
        if known in self._answered:
            return
        bounds = self._answered[known] = Bounds(final.start_ns, final.end_ns, now_ns, {"start", "end"})
        if len(self._answered) > MOST_ANSWERED:
            self._answered.popitem(last=False)
        for kind in ("start", "end"):
            pending = self._newest.pop((final.sensor, final.segment_id, kind), None)
            if pending is not None:
                bounds.lacks.discard(kind)
                if pending.mark.stamp_ns is None:
                    yield pending.placed(bounds)

    def tick(self, now_ns: int) -> Iterator[Placed]:
        """Yield the marks that have waited for long enough."""
        if now_ns <= self._due_ns:
            return
        for name in [name for name, pending in self._newest.items() if now_ns > pending.due_ns]:
            yield from self._settled(name)
        self._due_ns = min((pending.due_ns for pending in self._newest.values()), default=float("inf"))

    def close(self) -> Iterator[Placed]:
        """Yield the marks that still wait."""
        for name in [*self._newest]:
            yield from self._settled(name)

    def _lacking(self, mark: Segment, now_ns: int) -> Bounds | None:
        """Return the newest answer to a segment of this name, where it was given lately and lacks such a mark."""
        for (sensor, segment_id, *_), bounds in reversed(self._answered.items()):
            if (sensor, segment_id) == (mark.sensor, mark.segment_id):
                lacks_it = mark.kind in bounds.lacks and now_ns - bounds.since_ns <= MAX_SKEW_NS
                return bounds if lacks_it and mark.stamp_ns in (None, bounds.stamp_ns(mark)) else None
        return None

    def _settled(self, name: tuple[str, str, str]) -> Iterator[Placed]:
        """Let a mark wait no longer: it is that of the answer before it, or of none."""
        pending = self._newest.pop(name, None)
        if pending is None or pending.mark.stamp_ns is not None:
            return
        if pending.late_for is not None:
            pending.late_for.lacks.discard(pending.mark.kind)
        yield pending.placed(pending.late_for)
