"""A posture looks at the open segments about which it may decide, and at no others."""

from actum.limits import MAX_SEGMENT_NS
from actum.messages import Segment
from actum.node import SECOND_NS
from som_classifier.open_segments import OpenSegments
from som_classifier.segments import OpenSegment


def opened(*agents: int | None, start_ns: int | None = 0) -> OpenSegments:
    """Segments a, b, … of these agents."""
    segments = OpenSegments()
    for name, agent in zip("abc", agents, strict=False):
        mark = Segment(stamp_ns=0, sensor="s", kind="start", segment_id=name, agent=agent)
        segments.add(OpenSegment.of(mark, start_ns))
    return segments


def ids(segments: object) -> list[str]:
    return [each.segment_id for each in segments]  # type: ignore[attr-defined]


def test_segments_whose_end_mark_is_awaited_are_not_looked_at_with_each_posture() -> None:
    segments = opened(1, 2, None)
    assert ids(segments) == ["a", "b", "c"]
    assert ids(segments.undecided(SECOND_NS)) == ["c"], "nobody knows whose it is"
    segments["b"].end_ns = SECOND_NS
    segments.sort()
    assert ids(segments.undecided(SECOND_NS)) == ["b", "c"]
    segments.remove(segments["b"])
    assert ids(segments.undecided(SECOND_NS)) == ["c"]


def test_all_are_looked_at_once_one_may_be_too_long() -> None:
    segments = opened(1, 2)
    assert ids(segments.undecided(MAX_SEGMENT_NS)) == []
    assert ids(segments.undecided(MAX_SEGMENT_NS + 1)) == ["a", "b"]


def test_they_are_listed_by_agent() -> None:
    segments = opened(1, 2, None)
    assert [ids(segments.of(agent)) for agent in (1, 2, 3, None)] == [["a"], ["b"], [], ["c"]]
    segments["c"].nearest = 2
    segments.sort()
    assert [ids(segments.of(agent)) for agent in (2, None)] == [["b", "c"], []]


def test_those_without_a_start_begin_with_the_next_frame() -> None:
    segments = opened(1, start_ns=None)
    segments.date(7)
    segments.date(9)
    assert segments["a"].start_ns == 7
