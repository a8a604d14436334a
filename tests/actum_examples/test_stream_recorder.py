"""Recording live streams: every mark is stored with the stamp it was resolved to."""

from pathlib import Path

import pytest
from mcap.reader import make_reader

from actum import keys
from actum.limits import MAX_SKEW_NS
from actum.messages import (
    AUTO,
    MANUAL,
    REPLAY,
    SIMULATOR,
    Continuation,
    Image,
    Intent,
    Message,
    Segment,
    Skeleton,
    Truth,
)
from actum.node import SECOND_NS, SETTLE_NS, Counters
from actum.recorder import Recorder
from actum.recording import Recording
from actum_command.commands import segment_commands
from actum_command.scene_marks import mark_of
from actum_examples.stream_recorder import IMAGES, STREAMS, StreamRecorder
from empty_messages import action, contact, image, intent, mark, skeleton, status
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator, labelled_stream


class Take:
    """A recorder fed with messages that arrive a millisecond apart."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.counters = Counters()

    def record(self, *messages: Message, apart_ns: int = 1_000_000, **options: object) -> list[Message]:
        self.path.unlink(missing_ok=True)
        with Recorder(self.path, person="1", source="live") as recorder:
            stream = StreamRecorder(recorder, **options)  # type: ignore[arg-type]
            for i, message in enumerate(messages):
                stream.receive(message, received_ns=i * apart_ns)
            stream.close()
            self.counters = stream.counters
        return list(Recording(self.path).messages())

    def marks(self, *messages: Message, **options: object) -> list[tuple[str, int]]:
        recorded = self.record(*messages, **options)  # type: ignore[arg-type]
        return [(message.kind, message.stamp_ns) for message in recorded if isinstance(message, Segment)]


@pytest.fixture
def take(tmp_path: Path) -> Take:
    return Take(tmp_path / "live.mcap")


PLACED = {
    "a mark with a stamp is stored as it is": ([skeleton(10), mark("start", 7), action(8, 9)], [("start", 7)]),
    "one without gets the stamp that the classifier gave it": (
        [skeleton(10), mark("start"), skeleton(20), skeleton(30), mark("end"), skeleton(40), action(11, 31)],
        [("start", 11), ("end", 31)],
    ),
    "a partial action resolves nothing": (
        [skeleton(10), mark("start"), action(11, None, final=False), skeleton(20), action(12, 20)],
        [("start", 12)],
    ),
    "one that is overtaken by its final action is resolved too": (
        [skeleton(10), mark("start"), action(11, 31), mark("end")],
        [("start", 11), ("end", 31)],
    ),
    "those that nothing resolves get the stamp of the frame that was newest when they came": (
        [skeleton(10), mark("start"), skeleton(20), mark("end"), skeleton(30)],
        [("start", 10), ("end", 20)],
    ),
    "so does an end that the answer does not know": (
        [skeleton(10), mark("start"), skeleton(20), mark("end"), action(11, None)],
        [("start", 11), ("end", 20)],
    ),
    "a name that is used again after a restart gets the stamps of its own answer": (
        [
            skeleton(40),
            *(mark("start"), mark("end"), action(11, 31, session_id="a")),
            *(mark("start"), mark("end"), action(5, 25, session_id="b")),
        ],
        [("start", 5), ("start", 11), ("end", 25), ("end", 31)],
    ),
    "of a restart before the answer the marks of before keep the frame's stamp": (
        [skeleton(10), mark("start"), skeleton(90), mark("start"), mark("end"), action(95, 99, session_id="b")],
        [("start", 10), ("start", 95), ("end", 99)],
    ),
}


@pytest.mark.parametrize("case", PLACED)
def test_each_mark_is_stored_with_the_stamp_it_is_resolved_to(take: Take, case: str) -> None:
    stream, marks = PLACED[case]
    assert take.marks(*stream) == marks


@pytest.mark.parametrize("stamp_ns", [0, 1_790_000_000, 2**62 - 1])
def test_a_mark_outside_of_the_frames_is_counted_and_left_out(take: Take, stamp_ns: int) -> None:
    now_ns = 1_790_000_000 * SECOND_NS
    assert take.marks(skeleton(now_ns), mark("start", stamp_ns), mark("end", now_ns + MAX_SKEW_NS)) == [
        ("end", now_ns + MAX_SKEW_NS)
    ]
    assert take.counters.rejects == {"mark_outside_frames": 1}


def test_only_the_segments_own_action_resolves_its_marks(take: Take) -> None:
    stream = [skeleton(10), mark("start"), mark("start", segment_id="two"), action(3, 4, "two"), action(5, 6)]
    recorded = [m for m in take.record(*stream) if isinstance(m, Segment)]
    assert [(m.segment_id, m.stamp_ns) for m in recorded] == [("two", 3), ("one", 5)]


def test_a_mark_long_after_an_action_of_its_id_is_another_segments(take: Take) -> None:
    stream = [skeleton(10), mark("start"), action(11, 31), skeleton(99), mark("start")]
    assert take.marks(*stream, apart_ns=3 * SECOND_NS) == [("start", 11), ("start", 99)]


def test_a_mark_before_any_frame_cannot_be_placed_and_is_counted(take: Take) -> None:
    assert take.marks(mark("start")) == []
    assert take.counters.rejects == {"mark_without_stamp": 1}


def test_the_label_is_given_to_start_marks_that_have_none(take: Take) -> None:
    stream = [
        skeleton(1),
        mark("start", 1),
        mark("end", 2),
        mark("start", 3, "two", label="pull"),
        mark("start", 4, "x"),
    ]
    recorded = take.record(*stream, label="push")
    assert [m.label for m in recorded if isinstance(m, Segment)] == ["push", None, "pull", "push"]


def test_images_are_stored_only_if_asked_for(take: Take) -> None:
    assert [type(m) for m in take.record(skeleton(1), image(1))] == [Skeleton]
    assert [type(m) for m in take.record(skeleton(1), image(1), topics=STREAMS | IMAGES)] == [Skeleton, Image]


def test_what_people_are_about_to_touch_is_stored(take: Take) -> None:
    assert [type(m) for m in take.record(skeleton(1), intent(1, contact(0.9)), intent(2))] == [Skeleton, Intent, Intent]


def test_how_postures_go_on_is_not_stored_since_it_follows_from_the_postures(take: Take) -> None:
    ahead = Continuation(stamp_ns=1, sensor="kinect0", agent=1, ahead=[])
    assert [type(m) for m in take.record(skeleton(1), ahead)] == [Skeleton]


def test_marks_are_resolved_by_streams_that_are_not_stored(take: Take) -> None:
    stream = [skeleton(10), mark("start"), skeleton(20), mark("end"), action(11, 19)]
    assert take.marks(*stream, topics={keys.SEGMENT}) == [("start", 11), ("end", 19)]
    assert Recording(take.path).topics == {keys.SEGMENT}


def test_what_services_say_about_themselves_is_not_stored(take: Take) -> None:
    assert take.record(status()) == []


def test_a_mark_that_nothing_answers_is_stored_before_the_end_so_that_a_crash_does_not_cost_it(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="1", source="live") as recorder:
        stream = StreamRecorder(recorder)
        for message, received_ns in ((skeleton(10), 0), (mark("start"), 1), (skeleton(20), SETTLE_NS + 2)):
            stream.receive(message, received_ns)
        assert stream.stored == 3


def test_the_time_of_receipt_is_kept(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="1", source="live") as recorder:
        stream = StreamRecorder(recorder)
        stream.receive(skeleton(10), received_ns=500)
        stream.receive(mark("start"), received_ns=600)
        stream.receive(action(10, 20), received_ns=700)
        stream.close()
    with (tmp_path / "a.mcap").open("rb") as file:
        times = {(m.publish_time, m.log_time) for _, _, m in make_reader(file).iter_messages()}
    assert times == {(10, 500), (10, 600), (20, 700)}


def test_marks_of_others_are_left_out_and_counted(tmp_path: Path) -> None:
    of_the_scene = [mark("start", 1, "s1", origin=SIMULATOR), mark("end", 2, "s1", origin=SIMULATOR)]
    own = [mark("start", 3, "mine", origin=MANUAL), mark("end", 4, "mine", origin=MANUAL)]
    of_a_program = [mark("start", 5, "robot"), mark("end", 6, "robot")]
    with Recorder(tmp_path / "a.mcap", person="1", source="live") as recorder:
        stream = StreamRecorder(recorder, label="push")
        for message in (*of_the_scene, *own, *of_a_program, mark("start", 7, "played", origin=REPLAY)):
            stream.receive(message, received_ns=0)
    stored = [m for m in Recording(tmp_path / "a.mcap").messages() if isinstance(m, Segment)]
    assert [(m.segment_id, m.label) for m in stored if m.kind == "start"] == [("mine", "push"), ("robot", "push")]
    assert len(stored) == 4
    assert stream.actions == {(MANUAL, "push"): 2}
    assert stream.left_out == {SIMULATOR: 1, REPLAY: 1}


@pytest.mark.parametrize(("origins", "stored"), [((SIMULATOR,), ["s1"]), (None, ["s1", "mine"])])
def test_marks_of_others_are_stored_where_asked_for(origins: object, stored: list[str], take: Take) -> None:
    recorded = take.record(mark("start", 1, "s1", origin=SIMULATOR), mark("start", 2, "mine"), origins=origins)
    assert [m.segment_id for m in recorded if isinstance(m, Segment)] == stored


def test_the_scene_and_the_switch_say_that_marks_are_theirs() -> None:
    truth = Truth(
        stamp_ns=1, sensor="kinect0", kind="start", segment_id="s1", agent=1, hand="left", action="lift", object_id=1,
        object_name="cup", displacement_m=None,
    )  # fmt: skip
    assert mark_of(truth).origin == SIMULATOR
    assert segment_commands._mark("start", "a").origin == MANUAL
    labelled = labelled_stream(Simulator(balanced_programme(1, 0), image_hz=0))
    assert next(m for m in labelled if isinstance(m, Segment)).origin == SIMULATOR


def test_what_the_classifier_has_found_is_recorded_on_request(take: Take) -> None:
    """Without a label nothing is learnt from it; the label of the recording names it as it names a mark by hand."""
    found = [mark("start", 7, "auto-1", origin=AUTO), mark("end", 9, "auto-1", origin=AUTO)]
    stream = [skeleton(10), *found, action(7, 9, "auto-1")]
    assert take.marks(*stream) == []
    take.path.unlink()
    recorded = take.record(*stream, origins=(MANUAL, AUTO), label="wave")
    marks = [(m.kind, m.label, m.origin) for m in recorded if isinstance(m, Segment)]
    assert marks == [("start", "wave", AUTO), ("end", None, AUTO)]
