"""The open segments of one sensor, sorted so that a posture need not look at those about which it decides nothing."""

from collections import defaultdict
from collections.abc import Iterator, Sequence

from som_classifier.segments import OpenSegment, SegmentState

FAR_FUTURE_NS = 2**62
"""Stands for the end of what has none: later than any stamp."""


class OpenSegments:
    """The open segments by their ids, in the order in which they were opened."""

    def __init__(self) -> None:
        self._by_id: dict[str, OpenSegment] = {}
        self.sort()

    def __len__(self) -> int:
        return len(self._by_id)

    def __iter__(self) -> Iterator[OpenSegment]:
        """Iterate those that are open now, whatever closes meanwhile."""
        return iter(list(self._by_id.values()))

    def __getitem__(self, segment_id: str) -> OpenSegment:
        return self._by_id[segment_id]

    def get(self, segment_id: str) -> OpenSegment | None:
        """Return an open segment; None where none has this id."""
        return self._by_id.get(segment_id)

    def add(self, segment: OpenSegment) -> None:
        """Add one that is opened."""
        self._by_id[segment.segment_id] = segment
        self.sort()

    def remove(self, segment: OpenSegment) -> None:
        """Remove one that is closed."""
        del self._by_id[segment.segment_id]
        self.sort()

    def of(self, agent: int | None) -> Sequence[OpenSegment]:
        """List those of an agent; of None those of which nobody knows whose they are."""
        return self._of_agent.get(agent, ())

    def date(self, stamp_ns: int) -> None:
        """Let those begin now of which no frame had come yet from which they could begin, but not after their end."""
        for segment in self._undated:
            segment.start_ns = stamp_ns if segment.end_ns is None else min(stamp_ns, segment.end_ns)
        if self._undated:
            self.sort()

    def undecided(self, newest_ns: int | None) -> Sequence[OpenSegment]:
        """List those about which any posture may decide: they wait for last frames, or nobody knows whose they are.

        Once the newest stamp is later than some segment may end, list all.
        """
        is_any_over = newest_ns is not None and newest_ns > self._first_end_ns
        return list(self) if is_any_over else self._undecided

    def sort(self) -> None:
        """Note that the state, the agent or the start of a segment has changed."""
        segments = list(self)
        self._of_agent: dict[int | None, list[OpenSegment]] = defaultdict(list)
        for segment in segments:
            self._of_agent[segment.known_agent].append(segment)
        self._undated = [each for each in segments if each.start_ns is None]
        self._undecided = [each for each in segments if each.known_agent is None or each.state is SegmentState.ENDED]
        self._first_end_ns = min((each.latest_ns for each in segments), default=FAR_FUTURE_NS)
