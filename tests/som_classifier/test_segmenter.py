from collections.abc import Iterable

import numpy as np
import pytest

from actum.messages import Posture
from actum.node import SECOND_NS
from actum.stamps import RESTART_AFTER
from people import FRAME_NS, STANDING, reaches, reaching, skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from segmenter_runs import Run, mark, postures, stamps
from som_classifier.frames import Frame
from som_classifier.stream import Stream

BACK_NS = 90 * SECOND_NS
"""How far a clock steps back: further than any segment reaches."""


def posed(*people: tuple[np.ndarray, ...]) -> list[Posture]:
    """The postures of people, by their joints at each frame."""
    node = PosePreprocessor(PoseSettings.defaults())
    frames = [skeleton(i * FRAME_NS, *joints) for i, joints in enumerate(people)]
    return [p for frame in frames for p in node.handle(frame) if isinstance(p, Posture)]


def test_a_segment_is_the_frames_from_start_to_end_inclusive() -> None:
    run = Run().feed(mark("start", 5 * FRAME_NS), mark("end", 9 * FRAME_NS), *postures())
    assert [stamps(closed) for closed in run.closed] == [[5, 6, 7, 8, 9]]
    assert run.closed[0].agent == 1


def test_it_closes_with_the_frame_that_reaches_its_end() -> None:
    run = Run().feed(mark("start", 0), mark("end", 9 * FRAME_NS), *postures(9))
    assert run.closed == []
    assert len(run.feed(postures(10)[9]).closed) == 1


def other(posture: Posture) -> Posture:
    """The same instant of somebody else, who is seen beside the first."""
    return posture.model_copy(update={"agent": 2})


def test_it_closes_after_two_seconds_where_the_frames_of_others_go_on() -> None:
    run = Run().feed(*postures(10), mark("start", 0, agent=1), mark("end", 20 * FRAME_NS))
    run.feed(*map(other, postures(25)[10:])).wait(2.0)
    assert run.closed == []
    assert stamps(run.wait(0.3).closed[0]) == list(range(10))


def test_frames_that_are_still_to_be_captured_are_not_lost() -> None:
    """Somebody knows beforehand how long the action takes, or has a clock that is fast."""
    frames = postures(200)
    run = Run().feed(*frames[:10], mark("start", 15 * FRAME_NS, agent=1), mark("end", 180 * FRAME_NS))
    for i in range(10, len(frames), 3):
        run.feed(*frames[i : i + 3]).wait(0.1)
    assert [stamps(closed) for closed in run.closed] == [list(range(15, 181))]


def test_frames_of_another_clock_than_that_of_the_marks_are_not_waited_for() -> None:
    hours_ns = 10**5 * SECOND_NS
    run = Run().feed(*postures(10), mark("start", hours_ns), mark("end", hours_ns + SECOND_NS)).wait(10.4)
    assert run.reasons == ["frames lost: none came for the last 1.0 s of the segment"]


def test_while_nobodys_frames_come_it_waits_for_ten_seconds_and_answers_with_all_that_comes() -> None:
    frames = postures(30)
    run = Run().feed(*frames[:10], mark("start", 0), mark("end", 20 * FRAME_NS)).wait(8.0)
    assert run.closed == [], "a link may be cut, and its publisher keeps the frames"
    run.feed(frames[10]).wait(0.5)
    assert run.closed == [], "the others follow"
    assert stamps(run.feed(*frames[11:]).closed[0]) == list(range(21))


def test_it_closes_with_what_has_come_once_the_stream_has_stood_still_for_ten_seconds() -> None:
    run = Run().feed(*postures(10), mark("start", 0), mark("end", 20 * FRAME_NS)).wait(10.0)
    assert run.closed == []
    assert stamps(run.wait(0.4).closed[0]) == list(range(10))


def test_a_stream_that_stutters_for_ever_is_not_waited_for_for_ever() -> None:
    frames = postures(15)
    run = Run().feed(*frames[:5], mark("start", 0), mark("end", 20 * FRAME_NS))
    for frame in frames[5:]:
        run.wait(1.5).feed(frame)
    assert len(run.closed) == 1


def test_what_comes_after_the_answer_is_late_and_changes_nothing() -> None:
    run = Run().feed(*postures(10), mark("start", 0), mark("end", 20 * FRAME_NS)).wait(10.3)
    run.feed(*postures(15)[10:])
    assert len(run.closed) == 1
    assert run.counters.rejects["late"] == 5


def test_marks_after_the_fact_find_their_frames() -> None:
    run = Run().feed(*postures(), mark("start", 5 * FRAME_NS), mark("end", 9 * FRAME_NS))
    assert stamps(run.closed[0]) == [5, 6, 7, 8, 9]


def test_marks_without_stamp_take_the_newest_postures() -> None:
    frames = postures()
    run = Run().feed(*frames[:6], mark("start"), *frames[6:10], mark("end"), *frames[10:])
    assert stamps(run.closed[0]) == [5, 6, 7, 8, 9]


def test_a_start_before_the_first_posture_begins_with_it() -> None:
    frames = postures(10, first_ns=50 * FRAME_NS)
    run = Run().feed(mark("start"), *frames, mark("end"))
    assert stamps(run.closed[0]) == list(range(50, 60))


@pytest.mark.parametrize("end_ns", [None, 20 * FRAME_NS], ids=["no stamp", "a stamp of before"])
def test_what_was_marked_before_the_first_posture_does_not_end_before_it_starts(end_ns: int | None) -> None:
    run = Run().feed(mark("start"), mark("end", end_ns), *postures(10, first_ns=50 * FRAME_NS)).wait(2.3)
    assert run.reasons == ["no person"]
    assert run.closed[0].start_ns == run.closed[0].end_ns == (end_ns or 0)


def test_segments_may_overlap() -> None:
    marks = [
        mark("start", 0, "a"),
        mark("start", 5 * FRAME_NS, "b"),
        mark("end", 9 * FRAME_NS, "a"),
        mark("end", 12 * FRAME_NS, "b"),
    ]
    run = Run().feed(*marks, *postures())
    assert [(c.segment_id, len(c.frames)) for c in run.closed] == [("a", 10), ("b", 8)]


def test_start_without_end_is_given_up_when_no_end_can_come_any_more() -> None:
    start = mark("start", 0)
    within = postures(2, first_ns=62 * SECOND_NS - FRAME_NS)
    run = Run().feed(*postures(5), start, *within)
    assert run.closed == []
    run.feed(*postures(2, first_ns=62 * SECOND_NS + 1))
    assert run.reasons == ["start without end: no end within 60 s"]


def test_start_without_end_is_given_up_when_the_stream_has_fallen_silent() -> None:
    run = Run().feed(*postures(31), mark("start", 10 * FRAME_NS)).wait(61)
    assert run.closed == []
    assert run.wait(3).reasons == ["start without end: the frames ended 0.7 s after the start"]


@pytest.mark.parametrize("frames", [0, 5])
def test_start_without_end_and_without_frames_says_so(frames: int) -> None:
    run = Run().feed(*postures(frames), mark("start", 10 * FRAME_NS)).wait(64)
    assert run.reasons == ["start without end: no frame came after the start"]


def test_a_segment_of_more_than_sixty_seconds_is_rejected_at_its_end() -> None:
    run = Run().feed(*postures(5), mark("start", 0), mark("end", 60 * SECOND_NS + 1))
    assert run.reasons == ["start without end: no end within 60 s"]


@pytest.mark.parametrize("stamp_ns", [0, None])
def test_the_same_mark_again_is_counted_and_not_answered_twice(stamp_ns: int | None) -> None:
    frames = postures()
    run = Run().feed(*frames[:1], mark("start", stamp_ns), mark("start", stamp_ns), *frames[1:])
    run.feed(mark("end", 9 * FRAME_NS), mark("end", 9 * FRAME_NS))
    assert run.reasons == [None]
    assert run.counters.rejects["duplicate_mark"] == 2


@pytest.mark.parametrize("agent", [None, 1])
def test_why_no_frame_could_be_used_is_told_as_far_as_there_is_room(agent: int | None) -> None:
    blank = {"valid": False, "joints": None, "joints_m": None, "upright": None, "motion": None}
    frames = [p.model_copy(update={**blank, "reason": 500 * "no" + "t"}) for p in postures()]
    run = Run().feed(*frames, mark("start", 0, agent=agent), mark("end", 9 * FRAME_NS)).wait(3)
    (reason,) = run.reasons
    assert reason is not None
    assert "no usable frame (no" in reason or "with a usable frame (no" in reason
    assert len(reason) < 600


def test_no_stream_at_all() -> None:
    assert Run().feed(mark("start"), mark("end")).wait(2.3).reasons == ["no person"]


@pytest.mark.parametrize("fields", [{"valid": False}, {"joints": None}, {"motion": None}])
def test_a_posture_without_joints_or_motion_or_that_says_so_itself_is_no_valid_frame(fields: dict[str, object]) -> None:
    spoiled = [p.model_copy(update=fields) if i % 2 else p for i, p in enumerate(postures(10))]
    run = Run().feed(mark("start", 0), mark("end", 9 * FRAME_NS), *spoiled)
    assert [frame.valid for frame in run.closed[0].frames] == [True, False] * 5


def test_whose_a_segment_is_waits_two_seconds_for_the_postures_of_others() -> None:
    """Each frame names a second agent, nobody of whom ever comes."""
    alone = [p.model_copy(update={"agents": [1, 2]}) for p in postures(70)]
    run = Run().feed(mark("start", 0), mark("end", 9 * FRAME_NS), *alone[:60])
    assert run.closed == []
    run.feed(*alone[60:])
    assert [(closed.agent, len(closed.frames)) for closed in run.closed] == [(1, 10)]


@pytest.mark.parametrize(("agent", "acting"), [(None, 2), (1, 1)], ids=["nobody named", "the farther one named"])
@pytest.mark.parametrize("second_is_late", [False, True])
def test_the_agent_nearest_to_the_camera_at_the_first_valid_frame_unless_the_mark_names_one(
    agent: int | None, acting: int, second_is_late: bool
) -> None:
    """The nearest one is known only when all people of the frame have been heard."""
    far = STANDING + np.array([0.8, 0.0, 1.0])
    both = posed(*[(far + i * 1e-3, STANDING + i * 1e-3) for i in range(10)])
    ordered = sorted(both, key=lambda p: p.agent) if second_is_late else both
    run = Run().feed(mark("start", 0, agent=agent), mark("end", 9 * FRAME_NS), *ordered)
    assert [closed.agent for closed in run.closed] == [acting]


def test_lost_frames_are_counted_wherever_they_were_lost() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    kept: Iterable[Posture] = (
        p.model_copy(update={"seq": seq})
        for seq, frame in enumerate(f for f in reaches(20) if f.seq not in (3, 4))
        for p in node.handle(frame)
        if isinstance(p, Posture)
    )
    lost_again = [p for p in kept if p.seq != 10]
    run = Run().feed(*lost_again, mark("start", 0), mark("end", 19 * FRAME_NS))
    assert run.closed[0].missed == 3


def test_frames_lost_at_the_very_end_are_counted() -> None:
    frames = [p.model_copy(update={"seq": seq}) for seq, p in enumerate(postures(20))]
    run = Run().feed(*frames[:8], *frames[10:], mark("start", 0), mark("end", 9 * FRAME_NS))
    assert run.closed[0].missed == 2


def test_a_source_that_starts_anew_leaves_nothing_open() -> None:
    frames = postures(10)
    restarted = [p.model_copy(update={"session_id": "other"}) for p in postures(10)]
    run = Run().feed(*frames, mark("start", 0, "open"), mark("start", 0, "ended"), mark("end", 20 * FRAME_NS, "ended"))
    run.feed(*restarted)
    assert {c.segment_id: c.reason for c in run.closed} == {"open": "the source started anew", "ended": None}


def test_a_clock_that_steps_back_leaves_nothing_open() -> None:
    run = Run().feed(*postures(10, first_ns=BACK_NS), mark("start", BACK_NS)).feed(*postures(RESTART_AFTER))
    assert run.reasons == ["the source started anew"]


@pytest.mark.parametrize(("first_ns", "anew"), [(0, {"session_id": "other"}), (BACK_NS, {})], ids=["source", "clock"])
def test_what_was_marked_before_the_stamps_began_anew_does_not_mark_the_same_stamps_again(
    first_ns: int, anew: dict[str, str]
) -> None:
    marks = mark("start", first_ns), mark("end", first_ns + 5 * FRAME_NS)
    run = Run().feed(*postures(10, first_ns), *marks)
    assert run.segmenter.is_marked(1, first_ns, first_ns + FRAME_NS)
    run.feed(*[posture.model_copy(update=anew) for posture in postures(RESTART_AFTER)])
    assert not run.segmenter.is_marked(1, first_ns, first_ns + FRAME_NS)


def test_frames_of_whom_none_is_usable_are_not_looked_at_again_with_each_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many starts whose ends were forgotten would take the time of all others in view."""
    looked_at: list[Frame] = []
    between = Stream.between

    def counted(stream: Stream, start_ns: int, end_ns: int) -> list[Frame]:
        found = between(stream, start_ns, end_ns)
        looked_at.extend(found)
        return found

    monkeypatch.setattr(Stream, "between", counted)
    blank = {"valid": False, "joints": None, "joints_m": None, "upright": None, "motion": None, "reason": "dark"}
    frames = [p.model_copy(update=blank) for p in postures(100)]
    Run().feed(*[mark("start", 0, f"{i}") for i in range(8)], *frames)
    assert len(looked_at) < 10 * len(frames)


def test_frames_without_a_posture_belong_to_the_segment_but_not_to_the_recognition() -> None:
    mixed = posed(*[(reaching(i / 10) if i % 2 else np.zeros((15, 3)),) for i in range(10)])
    run = Run().feed(*mixed, mark("start", 0), mark("end", 9 * FRAME_NS))
    assert [frame.valid for frame in run.closed[0].frames] == [False, True] * 5


def test_of_very_many_answered_segments_the_newest_are_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mark that comes again is answered anew only where it is one of the oldest."""
    monkeypatch.setattr("som_classifier.answered_segments.REMEMBERED", 2)
    run = Run().feed(*postures(10))
    marks = {name: [mark("start", 0, name), mark("end", 5 * FRAME_NS, name)] for name in "abc"}
    run.feed(*marks["a"], *marks["b"], *marks["c"]).wait(2.3)
    assert sorted(closed.segment_id for closed in run.closed) == ["a", "b", "c"]
    run.feed(*marks["c"], *marks["b"]).wait(2.3)
    assert len(run.closed) == 3
    run.feed(*marks["a"]).wait(2.3)
    assert run.closed[-1].segment_id == "a"
    assert len(run.closed) == 4
