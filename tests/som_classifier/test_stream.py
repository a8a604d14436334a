"""A stream's frames have an activity as long as it is usually needed, and get it again where it is needed later."""

from collections.abc import Callable, Iterable
from functools import cache

import pytest

from actum.messages import Action, Message, Posture
from actum.node import SECOND_NS
from people import FRAME_NS
from performers import HAND_PATHS, TINY_PAPER
from recognisers import tiny_model
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.segments import OpenSegment
from som_classifier.spotting.search import NO_SEARCH, Search, SearchPlan
from som_classifier.stream import ACTIVITY_NS, FORGETTING_NS, Stream
from unmarked import Scene, postures, scene, spotting_model
from wire import without_seq

LATEST_NS = ACTIVITY_NS + FORGETTING_NS
MODELS = pytest.mark.parametrize("model_of", [spotting_model, lambda: tiny_model(TINY_PAPER)], ids=["pyramid", "paper"])


@cache
def acting() -> Scene:
    """Somebody who acts for half a minute."""
    return scene(tuple(HAND_PATHS) * 5, seed=3)


@cache
def seen() -> list[Posture]:
    return list(postures(acting().skeletons()))


class Counted(Stream):
    """A stream whose encoder counts the frames."""

    def __init__(self, plan: SearchPlan = NO_SEARCH) -> None:
        super().__init__(lambda: self.encode, Search(seen()[0], plan))
        self.calls = 0

    def encode(self, frame: Frame) -> int:
        self.calls += 1
        return frame.stamp_ns

    def fed(self, asked_ns: int | None = None) -> "Counted":
        """Feed all; ask with each frame for the stretch since a stamp, as for an open segment."""
        for posture in seen():
            self.add(posture)
            if asked_ns is not None and posture.stamp_ns >= asked_ns:
                self.stretch(asked_ns, posture.stamp_ns)
        return self


def finals(messages: Iterable[Message]) -> dict[str, Action]:
    return {
        m.segment_id: m for m in messages if isinstance(m, Action) and m.final and not m.segment_id.startswith("auto")
    }


def answered(model: Model, messages: Iterable[Message]) -> dict[str, Action]:
    node = SomClassifier(model)
    return finals(without_seq([answer for message in messages for answer in node.handle(message)]))


@MODELS
@pytest.mark.parametrize("backwards", [False, True], ids=["in order", "the newest first"])
def test_marks_after_the_fact_get_the_same_answers_to_the_last_bit(
    model_of: Callable[[], Model], backwards: bool
) -> None:
    model, marks = model_of(), [mark.model_copy(update={"label": None, "agent": 1}) for mark in acting().marks()]
    in_time = sorted([*marks, *seen()], key=lambda message: message.stamp_ns or 0)
    pairs = [marks[n : n + 2] for n in range(0, len(marks), 2)]
    late = [mark for pair in (reversed(pairs) if backwards else pairs) for mark in pair]
    assert seen()[-1].stamp_ns > 4 * LATEST_NS
    assert answered(model, in_time) == answered(model, [*seen(), *late])


def test_old_activities_are_forgotten() -> None:
    stream = Counted().fed()
    oldest_ns = min(frame.stamp_ns for frame in stream if frame.activity is not None)
    assert ACTIVITY_NS <= stream.newest_ns - oldest_ns <= LATEST_NS
    assert len(stream) == len(seen()) == stream.calls


def test_a_search_that_looks_further_back_keeps_them_for_longer() -> None:
    spotter = spotting_model().spotter(NO_SEARCH.options)
    assert spotter is not None
    spotter.memory_ns = 2 * LATEST_NS
    stream = Counted(SearchPlan(lambda: spotter)).fed()
    assert stream.newest_ns - min(f.stamp_ns for f in stream if f.activity is not None) >= spotter.memory_ns


def test_an_open_segment_keeps_them_from_its_start_on() -> None:
    stream = Counted().fed(asked_ns=3 * SECOND_NS)
    assert all(frame.activity is not None for frame in stream.between(3 * SECOND_NS, stream.newest_ns))
    assert stream.calls == len(seen())


def test_what_was_asked_for_once_is_forgotten_again() -> None:
    stream = Counted().fed()
    stream.cut(OpenSegment("late", 0, 1, end_ns=SECOND_NS))
    assert all(frame.activity is not None for frame in stream)
    for _ in range(2 * FORGETTING_NS // FRAME_NS):
        stream.add(seen()[-1].model_copy(update={"stamp_ns": stream.newest_ns + FRAME_NS, "seq": None}))
    assert all(frame.activity is None for frame in stream.between(0, stream.newest_ns - LATEST_NS))


def test_marks_from_the_newest_to_the_oldest_encode_no_frame_more_than_a_few_times() -> None:
    stream = Counted().fed()
    before = stream.calls
    for start_ns in range(stream.newest_ns, -1, -FRAME_NS):
        stream.cut(OpenSegment("late", start_ns, 1, end_ns=start_ns))
    assert stream.calls - before <= 2 * len(stream)


def test_another_model_reads_frames_that_were_kept_once_they_are_needed() -> None:
    stream = Counted().fed()
    before = stream.calls
    stream.use(lambda: lambda frame: -frame.stamp_ns)
    assert stream.calls == before
    frames = stream.stretch(20 * SECOND_NS, stream.newest_ns).usable
    assert [frame.activity for frame in frames] == [-frame.stamp_ns for frame in frames]
