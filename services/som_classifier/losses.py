"""Which part of a segment is lost: frames that were captured and have not come, or not to this process."""

from collections.abc import Sequence
from itertools import pairwise

from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.segments import OpenSegment
from som_classifier.streams import Streams

NO_END = "start without end: no end within 60 s"
"""The reason of a segment that is longer than any may be."""
UNPLACED = "the classifier had only just started, so it could not date a mark without a stamp"
"""The reason of a segment whose mark may have waited for the classifier."""
LOST_NS = SECOND_NS // 2
"""A part lost that is no longer than this (ns) tells little: most of an action is left."""
LOST_SHARE = 0.25
"""Nor does one of no more than this share of the segment."""
BEFORE_NS = SECOND_NS
"""How long before a segment frames are looked at (ns): the one before it tells whether the next one follows it."""


def why_incomplete(streams: Streams, start_ns: int, end_ns: int, resumed: bool) -> str | None:
    """Return the reason for which a segment cannot be answered as frames of it are lost; None where enough have come.

    Args:
        streams: the frames that have come, of all agents.
        start_ns: the segment's start.
        end_ns: its end.
        resumed: whether another process was there before this one.
    """
    frames = streams.since(start_ns - BEFORE_NS)
    if not frames:
        return "the classifier was not there: no frame has come since" if resumed else None
    least_ns = max(LOST_NS, LOST_SHARE * (end_ns - start_ns))
    first_ns, last_ns, before_ns = frames[0].stamp_ns, frames[-1].stamp_ns, frames[0].previous_ns
    if first_ns > start_ns + least_ns and before_ns is not None and before_ns >= start_ns:
        late_s = (first_ns - start_ns) / SECOND_NS
        return f"the classifier was not there: its first frame is {late_s:.1f} s after the start"
    ended_ns = end_ns - max(last_ns, start_ns)
    if ended_ns > least_ns:
        return f"frames lost: none came for the last {ended_ns / SECOND_NS:.1f} s of the segment"
    lost_ns = _lost_within(frames, start_ns, end_ns)
    return f"frames lost: none came for {lost_ns / SECOND_NS:.1f} s of the segment" if lost_ns > least_ns else None


def why_no_end(segment: OpenSegment, streams: Streams) -> str:
    """Return the reason for which a segment is given up whose end mark has not come."""
    newest_ns = streams.newest_ns
    if newest_ns is None or segment.start_ns is None or newest_ns < segment.start_ns:
        return "start without end: no frame came after the start"
    elapsed_s = (newest_ns - segment.start_ns) / SECOND_NS
    return f"start without end: the frames ended {elapsed_s:.1f} s after the start"


def _lost_within(frames: Sequence[Frame], start_ns: int, end_ns: int) -> int:
    """Return the longest time (ns) between two frames within bounds, between which some were captured."""
    gaps_ns = (
        min(then.stamp_ns, end_ns) - max(before.stamp_ns, start_ns)
        for before, then in pairwise(frames)
        if _is_broken(before, then)
    )
    return max(gaps_ns, default=0)


def _is_broken(before: Frame, then: Frame) -> bool:
    """Tell whether frames were lost between two, or a service before this one began anew."""
    if then.previous_ns is None:
        return before.previous_ns is not None
    return then.missed > 0 or then.previous_ns > before.stamp_ns
