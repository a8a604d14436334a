"""Whether the samples of a segment have come: an object that is chosen without them may be the wrong one."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from actum.messages import Action, Event
from actum.node import SECOND_NS

LOST_NS = SECOND_NS // 2
"""A part without samples that is no longer than this (ns) is interpolated well enough."""

LOST_SHARE = 0.25
"""So is one of no more than this share of the segment."""

LOST_INTERVALS = 4
"""So is one of no more than as many of the stream's usual intervals: a slow tracker is not a lost one."""


class Before:
    """The events that another process put before this one started; this process puts no others for their segments.

    Args:
        events: the known ones.
        resumed: whether another process ran before this one.
    """

    def __init__(self, events: Sequence[Event] = (), resumed: bool = False) -> None:
        self._answered = {(each.segment_id, each.start_ns, each.end_ns, each.session_id) for each in events}
        self._saw_objects = any(event.objects_present for event in events)
        self._resumed = resumed

    def answered(self, action: Action) -> bool:
        """Tell whether an action has its event already."""
        end_ns = action.start_ns if action.end_ns is None else action.end_ns
        return (action.segment_id, action.start_ns, end_ns, action.session_id) in self._answered

    def why_incomplete(
        self, postures_ns: Sequence[int], objects_ns: Sequence[int], start_ns: int, end_ns: int
    ) -> str | None:
        """Return the reason for which samples of a segment are lost; None where they have come.

        Args:
            postures_ns: stamps of all people's postures, rising, from some time before the segment on.
            objects_ns: those of the messages of objects.
            start_ns: the segment's start.
            end_ns: its end.
        """
        if self._resumed and not postures_ns:
            return "the fusion was not there: no posture has come since"
        if self._saw_objects and not objects_ns:
            return "the fusion was not there: no objects have come since"
        why = _why_postures_lost(postures_ns, start_ns, end_ns, self._resumed) if postures_ns else None
        return why or (_why_objects_lost(objects_ns, start_ns, end_ns) if objects_ns else None)


def _why_postures_lost(stamps_ns: Sequence[int], start_ns: int, end_ns: int, resumed: bool) -> str | None:
    """Return the reason for which postures do not reach over a segment; None where they do.

    Gaps between postures are no reason: the classifier knows which frames were captured, and has accepted the gaps.
    """
    least_ns = max(LOST_NS, LOST_SHARE * (end_ns - start_ns))
    late_ns = stamps_ns[0] - start_ns
    if resumed and late_ns > least_ns:
        return f"the fusion was not there: its first posture is {late_ns / SECOND_NS:.1f} s after the start"
    return _why_missing("postures", [(stamps_ns[-1], end_ns)], start_ns, least_ns)


def _why_objects_lost(stamps_ns: Sequence[int], start_ns: int, end_ns: int) -> str | None:
    """Return the reason for which a stream of objects does not cover a segment; None where it does."""
    usual_ns = float(np.median(np.diff(stamps_ns))) if len(stamps_ns) > 1 else 0.0
    least_ns = max(LOST_NS, LOST_SHARE * (end_ns - start_ns), LOST_INTERVALS * usual_ns)
    gaps_ns = ((before, min(then, end_ns)) for before, then in pairwise([*stamps_ns, end_ns]))
    late_ns = stamps_ns[0] - start_ns
    if late_ns > least_ns:
        return f"objects lost: the first came {late_ns / SECOND_NS:.1f} s after the start"
    return _why_missing("objects", gaps_ns, start_ns, least_ns)


def _why_missing(what: str, gaps_ns: Iterable[tuple[int, int]], start_ns: int, least_ns: float) -> str | None:
    lost_ns = max(then_ns - max(before_ns, start_ns) for before_ns, then_ns in gaps_ns)
    return f"{what} lost: none came for {lost_ns / SECOND_NS:.1f} s of the segment" if lost_ns > least_ns else None
