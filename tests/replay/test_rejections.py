"""Every mark that cannot be answered with a recognition is answered once, with its reason, from end to end."""

from itertools import accumulate
from itertools import chain as chained

import numpy as np
import pytest

from actum.messages import Action, Event, Message, Objects, Segment, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from chain import answers, by_key, delayed, replayed
from people import FRAME_NS, STANDING, reaches, skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model
from som_classifier.node import SomClassifier

FRAMES = 60
NOBODY_FROM, NOBODY_TO = 20, 40
FAR = 10**7
"""A frame of days ahead."""

NO_END = "start without end: no end within 60 s"
FRAMES_ENDED = "start without end: the frames ended 1.9 s after the start"
NO_FRAME = "start without end: no frame came after the start"


def frames() -> list[Skeleton]:
    """Two seconds of a person, who is away in the middle of them."""
    empty = {i: skeleton(i * FRAME_NS, seq=i) for i in range(NOBODY_FROM, NOBODY_TO)}
    return [empty.get(i, frame) for i, frame in enumerate(reaches(FRAMES))]


def mark(kind: str, frame: float, segment_id: str = "s", agent: int | None = None) -> Segment:
    stamp_ns = round(frame * FRAME_NS)
    fields = {"stamp_ns": stamp_ns, "sensor": "kinect0", "kind": kind, "segment_id": segment_id, "agent": agent}
    return Segment.model_validate(fields)


def told(
    *marks: Segment, skeletons: list[Skeleton] | None = None, at_the_latest_ns: int = 3 * SECOND_NS
) -> list[Message]:
    """The actions and events that follow from some marks, in a scene without objects.

    Marks come in their order, when they say or at the latest time given: they may be stamped ahead.
    """
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    captured = frames() if skeletons is None else skeletons
    postures = chained.from_iterable(preprocessor.handle(frame) for frame in captured)
    images = (Objects(stamp_ns=frame.stamp_ns, sensor="kinect0", objects=[]) for frame in captured)
    streams = {key: delayed(messages, [0]) for key, messages in by_key([*postures, *images]).items()}
    come_ns = accumulate((min(m.stamp_ns, at_the_latest_ns) for m in marks), max)
    return answers(streams | {"marks": list(zip(come_ns, marks, strict=True))})


def reasons(messages: list[Message]) -> list[tuple[str, str | None]]:
    """One action and one event of each, with the same reason."""
    actions = [(m.segment_id, m.reason) for m in messages if isinstance(m, Action)]
    events = [(m.segment_id, m.reason) for m in messages if isinstance(m, Event)]
    assert actions == events
    assert all(m.valid == (m.reason is None) for m in messages)
    return events


REJECTED: dict[str, tuple[tuple[Segment, ...], str]] = {
    "end without start": ((mark("end", 9),), "end without start"),
    "start never ended": ((mark("start", 2),), FRAMES_ENDED),
    "start never ended, of an agent": ((mark("start", 2, agent=1),), FRAMES_ENDED),
    "start in a far future": ((mark("start", FAR),), NO_FRAME),
    "longer than a minute": ((mark("start", 0), mark("end", 61 * 30)), NO_END),
    "end before start": ((mark("start", 12), mark("end", 3)), "end before start"),
    "nobody there": ((mark("start", NOBODY_FROM + 1), mark("end", NOBODY_TO - 2)), "no person"),
    "somebody else there": ((mark("start", 2, agent=7), mark("end", 12, agent=7)), "no person"),
    "after the last frame": (
        (mark("start", FAR), mark("end", FAR + 30)),
        "frames lost: none came for the last 1.0 s of the segment",
    ),
    "no frame": ((mark("start", 4.3), mark("end", 4.6)), "no person"),
    "no frame, of an agent": ((mark("start", 4.3, agent=1), mark("end", 4.6)), "no person"),
    "one frame": ((mark("start", 4), mark("end", 4)), "too few frames: 1, at least 3 are needed"),
    "two frames": ((mark("start", 4), mark("end", 5)), "too few frames: 2, at least 3 are needed"),
}


@pytest.mark.parametrize(("marks", "reason"), REJECTED.values(), ids=REJECTED.keys())
def test_it_is_answered_once_with_its_reason(marks: tuple[Segment, ...], reason: str) -> None:
    assert reasons(told(*marks)) == [("s", reason)]


@pytest.mark.parametrize(("marks", "reason"), REJECTED.values(), ids=REJECTED.keys())
def test_a_segment_over_it_is_recognised_all_the_same(marks: tuple[Segment, ...], reason: str) -> None:
    good = mark("start", 1, "good"), mark("end", 15, "good")
    together = sorted([*good, *marks], key=lambda m: m.stamp_ns)
    (recognised, *_) = [m for m in told(*together) if isinstance(m, Event) and m.segment_id == "good"]
    alone = [m for m in told(*good) if isinstance(m, Event)]
    assert [recognised.model_copy(update={"seq": 0})] == [m.model_copy(update={"seq": 0}) for m in alone]
    assert recognised.valid


def test_a_segment_is_recognised_where_there_are_three_frames() -> None:
    assert reasons(told(mark("start", 4), mark("end", 6))) == [("s", None)]


def test_a_person_whose_joints_are_never_usable() -> None:
    frozen = [skeleton(i * FRAME_NS, STANDING, seq=i) for i in range(20)]
    why = "(repeated_joints: all joints equal those of the previous frame, so the body tracker lost the person or is "
    why += "frozen: if this lasts, step into view, or restart the sensor service)"
    marks = mark("start", 3), mark("end", 12)
    assert reasons(told(*marks, skeletons=frozen)) == [("s", f"no person with a usable frame {why}")]
    of_agent = mark("start", 3, agent=1), mark("end", 12)
    assert reasons(told(*of_agent, skeletons=frozen)) == [("s", f"no usable frame {why}")]
    of_another = mark("start", 3, agent=2), mark("end", 12)
    assert reasons(told(*of_another, skeletons=frozen)) == [("s", "no person")]


def test_a_joint_that_nobody_can_do_without_is_named() -> None:
    no_torso = np.where(np.arange(15)[:, None] == INDEX["torso"], np.nan, STANDING)
    frames = [skeleton(i * FRAME_NS, no_torso, seq=i) for i in range(20)]
    ((_, reason),) = reasons(told(mark("start", 3), mark("end", 12), skeletons=frames))
    why = "(missing_joint: the skeleton lacks the joints torso: let the camera see the person's trunk)"
    assert reason == f"no person with a usable frame {why}"


@pytest.mark.parametrize(
    "marks",
    [
        (mark("start", 1), mark("start", 2), mark("end", 15)),
        (mark("start", 1), mark("start", 1), mark("end", 15), mark("end", 15)),
        (mark("start", 1), mark("end", 15), mark("start", 1), mark("end", 15)),
        (mark("start", 1), mark("end", 15), mark("end", 15)),
    ],
)
@pytest.mark.parametrize("at_the_latest_ns", [0, 3 * SECOND_NS], ids=["ahead of the frames", "in time"])
def test_a_mark_put_twice_is_answered_once(marks: tuple[Segment, ...], at_the_latest_ns: int) -> None:
    assert reasons(told(*marks, at_the_latest_ns=at_the_latest_ns)) == [("s", None)]


def test_a_name_used_again_is_answered_again_and_says_so() -> None:
    marks = mark("start", 1), mark("end", 15), mark("start", 42), mark("start", 42), mark("end", 50)
    assert sorted(reasons(told(*marks)), key=str) == [("s", "segment_id reused"), ("s", None)]


def slow_minute() -> list[Skeleton]:
    """More than a minute of a person, at three frames per second."""
    return [frame.model_copy(update={"stamp_ns": i * SECOND_NS // 3}) for i, frame in enumerate(reaches(200))]


def test_an_end_that_comes_when_the_segment_was_given_up_is_not_answered_again() -> None:
    marks = mark("start", 2), mark("end", 65 * 30)
    assert reasons(told(*marks, skeletons=slow_minute(), at_the_latest_ns=70 * SECOND_NS)) == [("s", NO_END)]


@pytest.mark.parametrize("agent", [None, 1])
def test_a_start_from_the_future_is_given_up_while_frames_go_on(agent: int | None) -> None:
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    frames = [(posture.stamp_ns, posture) for frame in slow_minute() for posture in preprocessor.handle(frame)]
    put = replayed(SomClassifier(tiny_model()), [(0, mark("start", FAR, agent=agent)), *frames])
    ((given_up_ns, action),) = put
    assert action.reason == NO_FRAME
    assert 62 * SECOND_NS < given_up_ns < frames[-1][0]
