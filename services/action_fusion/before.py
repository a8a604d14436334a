"""What was answered before this process was there."""

from collections.abc import Sequence

from actum.messages import Action, Event

Answered = tuple[str, int, int, str]
"""A segment's id, start and end (ns), and the session of the source."""


class Before:
    """The events that were put before this process was there.

    Args:
        events: those that are known.

    Attributes:
        resumed: whether another process was there before this one.
    """

    def __init__(self, events: Sequence[Event] = (), resumed: bool = False) -> None:
        self._answered = {(each.segment_id, each.start_ns, each.end_ns, each.session_id) for each in events}
        self._saw_objects = any(event.objects_present for event in events)
        self.resumed = resumed

    def answered(self, action: Action) -> bool:
        """Tell whether an action has its event already."""
        end_ns = action.start_ns if action.end_ns is None else action.end_ns
        return (action.segment_id, action.start_ns, end_ns, action.session_id) in self._answered

    def why_missing(self, has_postures: bool, has_objects: bool) -> str | None:
        """Return the reason where a stream that was there before has not come to this process."""
        if self.resumed and not has_postures:
            return "the fusion was not there: no posture has come since"
        if self._saw_objects and not has_objects:
            return "the fusion was not there: no objects have come since"
        return None
