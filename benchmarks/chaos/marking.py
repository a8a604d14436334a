"""The client that marks: it presses its switch on time, whatever becomes of the system."""

from collections.abc import Sequence
from dataclasses import dataclass

from actum.messages import Segment, Skeleton

from .scene import Planned, marks_of, session_start_ns

NOT_YET = float("inf")
"""When a mark was put that has not been put."""


@dataclass
class Marked:
    """An action that is marked in one session of the scene, and when its marks were put (s, monotonic)."""

    segment_id: str
    action: Planned
    start_ns: int
    end_ns: int
    started_s: float
    ended_s: float = NOT_YET


class Marker:
    """Marks the planned actions of each session of a scene, as time passes: a pure step over skeletons and clocks."""

    def __init__(self, actions: Sequence[Planned]) -> None:
        self._actions = actions
        self.marked: dict[str, Marked] = {}
        self.played = 0
        self.sessions = 0
        self._session_id = ""
        self._began_s = NOT_YET
        self._waiting: list[Planned] = []
        self._open: list[tuple[float, Planned, Segment | None]] = []

    def hear(self, skeleton: Skeleton, now_s: float) -> None:
        """Learn from a skeleton which session runs and when it began; the start of a session ends the plan before."""
        start_ns = session_start_ns(skeleton.session_id)
        if skeleton.session_id != self._session_id:
            self._session_id, self._began_s = skeleton.session_id, NOT_YET
            self._waiting = list(self._actions)
            self.sessions += 1
        self._began_s = min(self._began_s, now_s - (skeleton.stamp_ns - start_ns) / 1e9)

    def due(self, now_s: float, sensor: str, starting: bool = True) -> list[Segment]:
        """Return the marks whose time has come; unless `starting`, only ends, and actions go by unmarked."""
        put = []
        while self._waiting and self._began_s + self._waiting[0].start_ns / 1e9 <= now_s:
            action = self._waiting.pop(0)
            put += self._start(action, now_s, sensor) if starting else []
        for ending in [each for each in self._open if each[0] <= now_s]:
            self._open.remove(ending)
            put += self._end(ending, now_s)
        return put

    def _start(self, action: Planned, now_s: float, sensor: str) -> list[Segment]:
        session_ns = session_start_ns(self._session_id)
        ends_s = self._began_s + action.end_ns / 1e9
        if not action.marked:
            self._open.append((ends_s, action, None))
            return []
        name = f"m{self.sessions}-{action.number:03d}"
        start, end = marks_of(name, action, session_ns, sensor)
        self.marked[name] = Marked(name, action, start.stamp_ns or 0, end.stamp_ns or 0, now_s)
        self._open.append((ends_s, action, end))
        return [start]

    def _end(self, ending: tuple[float, Planned, Segment | None], now_s: float) -> list[Segment]:
        self.played += 1
        mark = ending[2]
        if mark is None:
            return []
        self.marked[mark.segment_id].ended_s = now_s
        return [mark]
