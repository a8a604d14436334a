"""Segments: marked, found and closed.

A segment is the frames with start <= stamp <= end; which belong to it is decided by stamps alone.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import NamedTuple

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.losses import longest_loss_s
from actum.messages import Hand, Segment
from som_classifier.frames import Frame

LONGEST_WHY = 500
"""Characters of a frame's reason that a segment's reason quotes: a source may send a text of any length."""


class SegmentState(Enum):
    """How far the segment of an id has come. Each transition is made in the method that is named here.

    - `NEW` → `OPEN` by a start mark: `Segmenter.mark`
    - `NEW` → `ANSWERED` by a mark that cannot be used: `Segmenter.mark`; by one that is not wanted:
      `Segmenter.decline`; by an answer of an earlier process: `AnsweredSegments.recall`
    - `OPEN` → `ENDED` by an end mark, → `ANSWERED` by one that cannot be used: `Segmenter.mark`
    - `OPEN`, `ENDED` → `ANSWERED` by frames: `Segmenter._settle`; by waiting: `Segmenter.tick`; by a restart of the
      source: `Segmenter._close_all`
    - `ANSWERED` → `USED_UP` by another mark: `AnsweredSegments.mark_again`; by a second answer of an earlier process:
      `AnsweredSegments.recall`
    - `ANSWERED`, `USED_UP` → `FORMER` by another session: `AnsweredSegments.end_session`
    - `FORMER` → `NEW` by a mark that is not one of the former segment: `AnsweredSegments.state`
    """

    NEW = "no mark has come"
    OPEN = "its end mark is awaited"
    ENDED = "its last frames are awaited"
    ANSWERED = "it is answered"
    USED_UP = "it is answered, and its id was used for another segment, which is rejected"
    FORMER = "it was answered in an earlier session of the source, so another segment may have its id"


class Marked(NamedTuple):
    """What is remembered of a marked segment that has been answered.

    Attributes:
        agent: whose it is; None where nobody knows.
        start_ns: its start.
        until_ns: the latest that its end may be.
    """

    agent: int | None
    start_ns: int
    until_ns: int


@dataclass
class OpenSegment:
    """A segment that is not answered yet.

    Attributes:
        segment_id: of its marks.
        start_ns: None until the first posture, where none had been seen when it started without a stamp.
        agent: who acts; None where the mark does not say so.
        hand: which hand acts; None where the mark does not say so.
        label: the action; None where the mark does not say so.
        end_ns: None until its end mark.
        nearest: the agent nearest to the camera, where the mark names none; None until it is determined.
        waiting_since_ns: the tick since which the segment waits for its end mark, or for the frames up to its end; a
            later one where these are not due yet.
    """

    segment_id: str
    start_ns: int | None
    agent: int | None
    hand: Hand | None = None
    label: str | None = None
    end_ns: int | None = None
    nearest: int | None = None
    waiting_since_ns: int | None = None

    @classmethod
    def of(cls, mark: Segment, start_ns: int | None) -> "OpenSegment":
        """Return the open segment of a mark."""
        return cls(mark.segment_id, start_ns, mark.agent, mark.hand, mark.label)

    @property
    def state(self) -> SegmentState:
        """`OPEN` until the end mark, then `ENDED`."""
        return SegmentState.OPEN if self.end_ns is None else SegmentState.ENDED

    @property
    def known_agent(self) -> int | None:
        """The agent that the mark names, or the nearest one; None where neither is known."""
        return self.nearest if self.agent is None else self.agent

    @property
    def latest_ns(self) -> int:
        """Its end or, where that is not known, the latest that it may have."""
        return (self.start_ns or 0) + MAX_SEGMENT_NS if self.end_ns is None else self.end_ns

    def is_too_long(self, newest_ns: int | None) -> bool:
        """Tell whether its end can come no more, as frames come that are newer than any that it may have."""
        return None not in (self.start_ns, newest_ns) and (newest_ns or 0) > self.latest_ns + MAX_SKEW_NS

    def ahead_ns(self, newest_ns: int | None) -> int:
        """Return how far its end is ahead of the newest frame (ns); 0 where that is too far for one clock."""
        ahead_ns = 0 if self.end_ns is None or newest_ns is None else self.end_ns - newest_ns
        return ahead_ns if 0 < ahead_ns <= MAX_SEGMENT_NS else 0

    def holds(self, stamp_ns: int) -> bool:
        """Tell whether an instant lies within it, as far as its start and end are known."""
        return (
            self.start_ns is not None and self.start_ns <= stamp_ns and (self.end_ns is None or stamp_ns <= self.end_ns)
        )

    def is_passed(self, newest_ns: int) -> bool:
        """Tell whether its end mark is awaited, and frames have come that are no older than its start."""
        return self.state is SegmentState.OPEN and self.start_ns is not None and self.start_ns <= newest_ns

    @property
    def marked(self) -> Marked | None:
        """What it covers: it lasts no longer than a segment may; None where its start is not known."""
        if self.start_ns is None:
            return None
        longest_ns = self.start_ns + MAX_SEGMENT_NS
        return Marked(self.known_agent, self.start_ns, min(longest_ns, self.end_ns or longest_ns))

    def rejected(self, reason: str) -> "ClosedSegment":
        """Return the segment closed, without frames and with the reason for which it is rejected."""
        return self.closed([], 0, reason)

    def closed(self, frames: list[Frame], missed: int, reason: str | None) -> "ClosedSegment":
        """Return the segment closed: with these frames, those lost on the way, and why it cannot be recognised."""
        start_ns = self.start_ns if self.start_ns is not None else 0
        end_ns = self.end_ns if self.end_ns is not None else start_ns
        return ClosedSegment(
            self.segment_id, start_ns, end_ns, self.known_agent or 0, self.hand, self.label, frames, missed, reason
        )


@dataclass(frozen=True)
class ClosedSegment:
    """A segment that is to be answered.

    Attributes:
        frames: all of its frames that have come, valid or not.
        missed: how many of its frames were lost on the way.
        reason: why it is rejected; None where it may be recognised.
    """

    segment_id: str
    start_ns: int
    end_ns: int
    agent: int
    hand: Hand | None
    label: str | None
    frames: list[Frame]
    missed: int
    reason: str | None

    @cached_property
    def usable(self) -> list[Frame]:
        """The valid frames."""
        return [frame for frame in self.frames if frame.valid]

    @property
    def is_seen_to_its_end(self) -> bool:
        """Whether they reach its end, or nearly; where a person has left before, they show how an action begins."""
        last_ns = self.usable[-1].stamp_ns if self.usable else self.start_ns
        return longest_loss_s([(last_ns, self.end_ns)], self.start_ns, self.end_ns) is None


def with_cause(reason: str, cause: str | None) -> str:
    """Return a reason with its cause, where there is one."""
    return f"{reason} ({cause[:LONGEST_WHY]})" if cause else reason
