"""Whether the samples of a segment have come: an object that is chosen without them may be the wrong one."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.arrays import median
from actum.losses import LOST_NS, longest_loss_s
from actum.messages import Action, Event

LOST_INTERVALS = 4
"""A part without objects of no more than as many of their usual intervals is no loss: the tracker may be slow."""


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
        self, postures_ns: Sequence[int], objects_ns: NDArray[np.int64], start_ns: int, end_ns: int
    ) -> str | None:
        """Return the reason for which samples of a segment are lost; None where they have come.

        Gaps between postures are no reason: the classifier knows which frames were captured, and has accepted the gaps.

        Args:
            postures_ns: stamps of postures, rising, from some time before the segment on; everybody's first and last.
            objects_ns: those of the messages of objects.
            start_ns: the segment's start.
            end_ns: its end.
        """
        if self._resumed and not postures_ns:
            return "the fusion started late: it has received no posture since its start"
        if self._saw_objects and not len(objects_ns):
            return "the fusion started late: it has received no objects since its start"
        if self._resumed and (late_s := longest_loss_s([(start_ns, postures_ns[0])], start_ns, end_ns)):
            return f"the fusion started late: its first posture is {late_s:.1f} s after the segment's start"
        if postures_ns and (lost_s := longest_loss_s([(postures_ns[-1], end_ns)], start_ns, end_ns)):
            return f"postures lost: none came for {lost_s:.1f} s of the segment"
        return _why_objects_lost(objects_ns, start_ns, end_ns) if len(objects_ns) else None


def _why_objects_lost(stamps_ns: NDArray[np.int64], start_ns: int, end_ns: int) -> str | None:
    """Return the reason for which a stream of objects does not cover a segment; None where it does."""
    usual_ns = float(median(np.diff(stamps_ns))) if len(stamps_ns) > 1 else 0.0
    stamps_ns = stamps_ns[max(np.searchsorted(stamps_ns, start_ns) - 1, 0) :]
    tolerated_ns = max(LOST_NS, LOST_INTERVALS * usual_ns)
    if late_s := longest_loss_s([(start_ns, int(stamps_ns[0]))], start_ns, end_ns, tolerated_ns):
        return f"objects lost: the first came {late_s:.1f} s after the start"
    gaps_ns = zip(stamps_ns.tolist(), [*np.minimum(stamps_ns[1:], end_ns).tolist(), end_ns], strict=True)
    lost_s = longest_loss_s(gaps_ns, start_ns, end_ns, tolerated_ns)
    return None if lost_s is None else f"objects lost: none came for {lost_s:.1f} s of the segment"
