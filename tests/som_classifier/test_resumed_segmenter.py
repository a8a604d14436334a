"""What the segmenter answers where it, or what stands before it, was not there all the time."""

from actum.messages import Action, Posture
from people import FRAME_NS
from segmenter_runs import Run, mark, postures
from som_classifier.answers import final_action
from som_classifier.segments import ClosedSegment


def in_session(name: str, frames: list[Posture]) -> list[Posture]:
    return [frame.model_copy(update={"session_id": name}) for frame in frames]


def test_the_end_of_a_segment_that_the_source_cut_short_is_not_answered_again() -> None:
    run = Run().feed(*postures(10), mark("start", 0), *in_session("other", postures(10)))
    assert run.reasons == ["the source started anew"]
    run.feed(mark("end", 20 * FRAME_NS), mark("start", 0), mark("end", 20 * FRAME_NS))
    assert run.reasons == ["the source started anew"], "however often its marks are told"


def test_an_id_may_be_used_again_once_the_source_has_started_anew() -> None:
    run = Run().feed(*postures(10), mark("start", 0), mark("end", 5 * FRAME_NS), *in_session("other", postures(10)))
    run.feed(mark("start", FRAME_NS), mark("end", 6 * FRAME_NS))
    assert run.reasons == [None, None]


def answer(closed: ClosedSegment, session_id: str = "") -> Action:
    return final_action(closed, None, closed.reason or "no model", "kinect0", session_id=session_id)


def test_what_was_answered_before_a_restart_is_not_answered_again() -> None:
    frames, marks = postures(30), [mark("start", FRAME_NS), mark("end", 5 * FRAME_NS)]
    before = Run().feed(*frames, *marks)
    run = Run().remember(*map(answer, before.closed)).feed(*marks, *frames, *marks).wait(3.0)
    assert run.closed == []
    assert run.counters.counts["marks_told_again"] == 2
    assert run.counters.rejects == {"duplicate_mark": 2}, "who marks it once more is told"
    assert run.segmenter.is_marked(1, 2 * FRAME_NS, 3 * FRAME_NS), "nor is it found without marks"


def test_an_id_that_was_used_again_before_a_restart_is_not_rejected_once_more() -> None:
    frames = postures(30)
    marks = [mark(kind, (first + 5 * (kind == "end")) * FRAME_NS) for first in (1, 11, 21) for kind in ("start", "end")]
    before = Run().feed(*frames, *marks)
    assert before.reasons == [None, "segment_id reused", "segment_id reused"]
    run = Run().remember(*map(answer, before.closed)).feed(*frames, *marks)
    assert run.closed == []
    assert run.feed(mark("start", 25 * FRAME_NS)).reasons == ["segment_id reused"]


def test_what_was_given_up_before_a_restart_is_not_answered_again() -> None:
    before = Run().feed(*postures(5), mark("start", 0)).wait(64)
    run = Run().remember(*map(answer, before.closed)).feed(mark("start", 0), mark("end", 9 * FRAME_NS))
    assert run.closed == []


def test_answers_of_before_say_nothing_of_another_session() -> None:
    marks = [mark("start", 0), mark("end", 5 * FRAME_NS)]
    before = Run().feed(*in_session("first", postures()), *marks)
    again = [mark("start", FRAME_NS), mark("end", 6 * FRAME_NS)]
    answers = [answer(closed, "first") for closed in before.closed]
    run = Run().remember(*answers).feed(*in_session("second", postures()), *again)
    assert [len(closed.frames) for closed in run.closed] == [6]


def test_a_mark_that_comes_before_the_first_frame_of_another_session_is_a_mark_of_this_session() -> None:
    before = Run().feed(*in_session("first", postures()), mark("start", 0), mark("end", 5 * FRAME_NS))
    run = Run().remember(*(answer(closed, "first") for closed in before.closed))
    run.feed(mark("start", FRAME_NS, "b"), *in_session("second", postures()), mark("end", 6 * FRAME_NS, "b"))
    assert run.reasons == [None]


def test_after_a_restart_a_segment_whose_first_frames_are_gone_is_rejected() -> None:
    frames = postures(90)
    run = Run().remember().feed(mark("start", 0), mark("end", 60 * FRAME_NS), *frames[30:]).wait(2.3)
    assert run.reasons == ["the classifier started late: its first frame is 1.0 s after the segment's start"]


def test_after_a_restart_a_segment_is_answered_where_only_little_of_it_is_gone() -> None:
    run = Run().remember().feed(mark("start", 0), mark("end", 60 * FRAME_NS), *postures(90)[10:])
    assert [len(closed.frames) for closed in run.closed] == [51]


def test_after_a_restart_a_segment_without_any_frame_says_so_once_none_may_come() -> None:
    run = Run().remember().feed(mark("start", 0), mark("end", 60 * FRAME_NS)).wait(9.0)
    assert run.closed == []
    assert run.wait(4.0).reasons == ["the classifier started late: it has received no frame since its start"]


def test_just_after_a_restart_a_mark_without_a_stamp_cannot_be_placed() -> None:
    run = Run().remember().feed(*postures(10), mark("start"), mark("end"))
    assert run.reasons == ["the classifier had only just started, so it could not date a mark without a stamp"]
    run.wait(1.2).feed(mark("start", None, "later"), *postures(15)[10:], mark("end", None, "later"))
    assert len(run.reasons) == 2 and run.reasons[1] is None


def test_frames_lost_within_a_segment_make_it_a_rejection() -> None:
    """As where the preprocessor is killed: the frame after the gap follows one that never came."""
    frames = postures(90)
    anew = frames[50].model_copy(update={"previous_ns": None})
    for after in (frames[50], anew):
        run = Run().feed(*frames[:20], after, *frames[51:], mark("start", 0), mark("end", 60 * FRAME_NS))
        assert run.reasons == []  # they may yet come
        assert run.wait(3.0).reasons == ["frames lost: none came for 1.0 s of the segment"]


def test_frames_that_were_never_captured_are_not_lost() -> None:
    frames = postures(90)
    after = frames[50].model_copy(update={"previous_ns": frames[19].stamp_ns})
    run = Run().feed(*frames[:20], after, *frames[51:], mark("start", 0), mark("end", 60 * FRAME_NS))
    assert run.reasons == [None]


def test_a_stream_that_ends_early_makes_it_a_rejection() -> None:
    run = Run().feed(*postures(30), mark("start", 0), mark("end", 60 * FRAME_NS)).wait(11.0)
    assert run.reasons == ["frames lost: none came for the last 1.0 s of the segment"]


def test_an_end_without_a_stamp_just_after_a_restart_rejects_the_open_segment_once() -> None:
    run = Run().remember().feed(*postures(10), mark("start", FRAME_NS), mark("end", None)).wait(64)
    assert run.reasons == ["the classifier had only just started, so it could not date a mark without a stamp"]
