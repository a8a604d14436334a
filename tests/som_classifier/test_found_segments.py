"""Actions that nobody marked: the node marks and answers what its model spots, per person, by stamps alone."""

import random
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import AUTO, Action, HeldBack, Message, Posture, Segment
from actum.node import SECOND_NS, Tick, replay
from people import FRAME_NS, reaching, skeleton
from performers import TINY_PAPER
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from recognisers import tiny_model
from som_classifier.model import Model
from som_classifier.node import MARKS_OFF, POLL_TICKS, SomClassifier
from som_classifier.pyramid_model import PyramidModel
from som_classifier.segmentation import CANNOT, DEFAULT, NO_BACKGROUND, Segmentation
from som_classifier.settings import Settings
from som_classifier.spotting.spotted import SpottedSegment, SpottingOptions
from spotters import Beats, Box, beating, finding, spotting
from wire import Wire, packed, without_seq

BESIDE_M = np.array([0.8, 0.0, 0.1])
START_NS = 100 * SECOND_NS
LIFT = SpottedSegment(START_NS + 10 * FRAME_NS, START_NS + 30 * FRAME_NS, "lift")
PUSH = SpottedSegment(START_NS + 40 * FRAME_NS, START_NS + 60 * FRAME_NS, "push")


@cache
def stream(frames: int = 90, people: int = 1, first_ns: int = START_NS, session: str = "test") -> tuple[Posture, ...]:
    """People who reach out once a second, each in their own rhythm."""
    node = PosePreprocessor(PoseSettings.defaults())
    put: list[Posture] = []
    for i in range(frames):
        bodies = [reaching(abs(i * (n + 2) % 30 - 14.9) / 15) + n * BESIDE_M for n in range(people)]
        frame = skeleton(first_ns + i * FRAME_NS, *bodies, seq=i, session_id=session)
        put += [m for m in node.handle(frame) if isinstance(m, Posture)]
    return tuple(put)


def put_by(node: SomClassifier, messages: Iterable[Message | Tick]) -> list[Message]:
    """What a node puts, as a service: its own marks come back to it, as Zenoh brings them."""
    wire = Wire(node)
    put: list[Message] = []
    for message in messages:
        answers = wire.handle(message) if isinstance(message, Tick) else wire.send(message)
        put += answers
        assert not wire.send(*[answer for answer in answers if isinstance(answer, Segment)])
    return put


def found(messages: Iterable[Message]) -> list[tuple[int, int, int]]:
    return [(m.agent, m.start_ns, m.end_ns or 0) for m in messages if isinstance(m, Action) and m.final]


def partials(messages: Iterable[Message]) -> list[Action]:
    return [m for m in messages if isinstance(m, Action) and not m.final]


def mark(kind: str, frame: int, segment_id: str = "hand", **more: object) -> Segment:
    fields = {"sensor": "kinect0", "kind": kind, "segment_id": segment_id, "stamp_ns": START_NS + frame * FRAME_NS}
    return Segment.model_validate(fields | more)


def bounds(segment: SpottedSegment, agent: int = 1) -> tuple[int, int, int]:
    return agent, segment.start_ns, segment.end_ns


def test_a_found_segment_is_marked_by_start_and_end_and_then_answered_as_any_marked_one() -> None:
    node = SomClassifier(finding(tiny_model(), LIFT))
    *_, start, end, action = put_by(node, stream())
    assert isinstance(start, Segment) and isinstance(end, Segment) and isinstance(action, Action)
    assert [(m.kind, m.stamp_ns, m.agent, m.origin, m.label) for m in (start, end)] == [
        ("start", LIFT.start_ns, 1, AUTO, None),
        ("end", LIFT.end_ns, 1, AUTO, None),
    ]
    assert start.segment_id == end.segment_id == action.segment_id
    marks = [m.model_copy(update={"origin": None}) for m in (start, end)]
    by_marks = SomClassifier(finding(tiny_model(), LIFT), segmentation=Segmentation("marks"))
    (marked,) = [m for m in put_by(by_marks, [*stream(), *marks]) if isinstance(m, Action)]
    assert without_seq([action]) == without_seq([marked])
    assert (action.valid, action.final, node.counters.rejects) == (True, True, {})
    assert node.counters.counts == {"found": 1, "told": 1}


def test_in_valid_postures_of_nobody_nothing_is_found() -> None:
    node = SomClassifier(finding(tiny_model(), LIFT))
    assert put_by(node, [each.model_copy(update={"agent": 0, "agents": []}) for each in stream()]) == []
    assert node.counters.counts == {}


def test_while_it_goes_on_partial_actions_say_how_far_it_is_under_the_id_that_it_will_have() -> None:
    put = put_by(SomClassifier(finding(tiny_model(), LIFT, PUSH)), stream())
    finals = [m for m in put if isinstance(m, Action) and m.final]
    for segment, final in zip((LIFT, PUSH), finals, strict=True):
        own = [p for p in partials(put) if p.segment_id == final.segment_id]
        assert [p.stamp_ns for p in own] == list(range(segment.start_ns, segment.end_ns + 1, FRAME_NS))
        assert {(p.action, p.confidence, p.start_ns, p.end_ns) for p in own} == {
            (segment.label, 0.9, segment.start_ns, None)
        }
        done = [p.completeness for p in own]
        assert (done[0], done[-1]) == (0.0, 1.0) and done == sorted(done, key=lambda share: share or 0.0)
        assert [p.frames for p in own] == list(range(1, len(own) + 1))
        assert final.completeness is None
    assert len({m.segment_id for m in finals}) == 2


def test_its_own_marks_are_neither_answered_again_nor_counted() -> None:
    node = SomClassifier(finding(tiny_model(), LIFT, PUSH))
    put = put_by(node, stream())
    assert found(put) == [bounds(LIFT), bounds(PUSH)]
    assert not node.counters.rejects


def test_what_another_classifier_has_marked_is_not_answered_again() -> None:
    """As after a restart, when the marks of the process before are recovered."""
    node = SomClassifier(tiny_model())
    other = put_by(SomClassifier(finding(tiny_model(), LIFT)), stream())
    assert put_by(node, [*stream(), *[m for m in other if isinstance(m, Segment)]]) == []
    assert not node.counters.rejects


def held_back(messages: Iterable[Message]) -> list[tuple[str, int, int, str, str]]:
    found = [m for m in messages if isinstance(m, HeldBack)]
    return [(m.action, m.start_ns, m.end_ns, m.why, m.sentence.partition(":")[0]) for m in found]


def test_a_segment_that_cannot_be_answered_is_held_back_and_counted() -> None:
    lost = [p.model_copy(update={"valid": False, "reason": "lost", "joints": None}) for p in stream()]
    node = SomClassifier(finding(tiny_model(), LIFT))
    put = put_by(node, lost)
    assert not found(put)
    few = "perhaps lift, but with too few usable frames to recognise"
    assert held_back(put) == [("lift", LIFT.start_ns, LIFT.end_ns, "unanswerable", few)]
    assert (node.counters.counts, node.counters.rejects) == ({"found": 1, "unanswerable": 1}, {})


@pytest.mark.parametrize("called", ["unknown", "doubtful"])
def test_what_the_recogniser_calls_unknown_is_held_back_and_counted(
    called: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The search may take for an action what no background sample has shown."""
    recognise = PyramidModel.recognise
    monkeypatch.setattr(PyramidModel, "recognise", lambda *asked: replace(recognise(*asked), **{called: True}))
    node = SomClassifier(finding(tiny_model(), LIFT))
    put = put_by(node, stream())
    assert not found(put) and not [m for m in put if isinstance(m, Segment)]
    [(_, start_ns, end_ns, why, sentence)] = held_back(put)
    assert (start_ns, end_ns, why) == (LIFT.start_ns, LIFT.end_ns, "unknown")
    assert re.fullmatch(r"like \w+, but not like enough", sentence)
    assert node.counters.counts == {"found": 1, "unknown": 1} and not node.counters.rejects


@pytest.mark.parametrize("precision", [1.0, 0.5, 0.0])
def test_what_is_found_is_as_familiar_as_if_marked_as_often_as_the_search_is_right_and_published_all_the_same(
    precision: float,
) -> None:
    *_, marked = put_by(SomClassifier(finding(tiny_model(), LIFT)), stream())
    *_, action = put_by(SomClassifier(finding(tiny_model(), replace(LIFT, precision=precision))), stream())
    assert isinstance(marked, Action) and marked.familiarity and isinstance(action, Action)
    assert action == marked.model_copy(update={"familiarity": pytest.approx(precision * marked.familiarity)})


@settings(max_examples=12, deadline=None)
@given(length=st.integers(0, 200), people=st.integers(1, 3))
def test_a_prefix_of_a_stream_gives_the_same_decisions(length: int, people: int) -> None:
    model = beating(tiny_model())
    whole = stream(66, people)
    begun = put_by(SomClassifier(model), whole[:length])
    assert without_seq(put_by(SomClassifier(model), whole))[: len(begun)] == without_seq(begun)


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(), delays_s=st.lists(st.floats(0.0, 2.0), min_size=3, max_size=3))
def test_delays_and_interleaving_of_people_change_nothing_of_anybodys_segments(
    seed: int, delays_s: Sequence[float]
) -> None:
    """Neither do ticks between, nor who else there is."""
    model, rng = beating(tiny_model()), random.Random(seed)
    people = stream(66, 3)
    arrivals = [
        (p.stamp_ns + round(delays_s[p.agent - 1] * SECOND_NS) + rng.randrange(FRAME_NS) * (p.agent > 1), p)
        for p in people
    ]
    ordered = sorted(arrivals, key=lambda arrival: arrival[0])
    together = list(replay(SomClassifier(model), ordered))
    for agent in (1, 2, 3):
        own = [p for p in people if p.agent == agent]
        alone = put_by(SomClassifier(model), own)
        assert found(alone)
        assert without_seq([m for m in together if getattr(m, "agent", None) == agent]) == without_seq(alone)


def test_ids_are_unique_where_anything_begins_anew() -> None:
    """The sensor with its clock from the same stamp, the classifier in midst of a stream, a person who comes back."""
    model = beating(tiny_model())
    whole = stream(66)
    long_after = stream(66, first_ns=START_NS + 100 * SECOND_NS)
    others = [p.model_copy(update={"agent": 2, "agents": [2]}) for p in stream(3, first_ns=START_NS + 90 * SECOND_NS)]
    anew = stream(66, session="another")
    runs = [
        put_by(SomClassifier(model), [*whole, *others, *long_after, *anew]),
        put_by(SomClassifier(model), whole[4:]),
    ]
    ids = [m.segment_id for put in runs for m in put if isinstance(m, Action) and m.final]
    assert len(ids) == len(set(ids)) >= 8
    again = put_by(SomClassifier(model), whole)
    assert [m.segment_id for m in again if isinstance(m, Action) and m.final] == ids[:2]


@pytest.mark.parametrize("of_before", [(), stream(66, session="earlier")], ids=["one session", "the source anew, too"])
def test_what_was_found_before_a_restart_is_not_found_again_nor_is_its_id_used_again(
    of_before: tuple[Posture, ...],
) -> None:
    """The new process gets postures once more from the beginning."""
    model, whole = beating(tiny_model()), [*of_before, *stream(66)]
    before = [m for m in put_by(SomClassifier(model), whole[:-20]) if isinstance(m, Action) and m.final]
    node = SomClassifier(model)
    node.remember(before)
    after = [m for m in put_by(node, whole) if isinstance(m, Action) and m.final]
    assert len(after) == 1
    assert without_seq(before + after) == without_seq(
        [m for m in put_by(SomClassifier(model), whole) if isinstance(m, Action) and m.final]
    )


def test_a_clock_that_steps_back_begins_a_new_search_with_new_ids() -> None:
    back = [p.model_copy(update={"seq": None}) for p in stream(66, first_ns=START_NS - 90 * SECOND_NS)]
    put = put_by(SomClassifier(beating(tiny_model())), [*stream(66), *back])
    ids = [m.segment_id for m in put if isinstance(m, Action) and m.final]
    assert len(ids) == len(set(ids)) == 4


def test_a_person_who_vanishes_in_the_middle_leaves_nothing_behind() -> None:
    gone, back = stream()[:25], stream(66, first_ns=START_NS + 5 * SECOND_NS)
    node = SomClassifier(beating(tiny_model()))
    put = put_by(node, [*gone, *[Tick(i * SECOND_NS) for i in range(80)], *back])
    assert [start_ns >= back[0].stamp_ns for _, start_ns, _ in found(put)] == [True, True]
    assert not node.counters.rejects


def test_another_model_goes_on_with_a_search_of_its_own_and_with_the_numbers() -> None:
    box = Box()
    node = SomClassifier(beating(tiny_model()), box)
    before = put_by(node, stream(120)[:40])
    box.model = spotting(tiny_model(), lambda _: Beats("push"))
    after = put_by(node, [*[Tick(i) for i in range(POLL_TICKS)], *stream(120)[40:]])
    assert {p.action for p in partials(before)} == {"lift"} and {p.action for p in partials(after)} == {"push"}
    ids = [m.segment_id for m in [*before, *after] if isinstance(m, Action) and m.final]
    assert len(ids) == len(set(ids)) == 4 - 1  # the one that goes on at the change is lost
    assert [name.rsplit("-", 1)[1] for name in ids] == ["1", "2", "3"]


marked = pytest.mark.parametrize(
    ("frames", "wins"),
    [((0, 9), False), ((5, 10), True), ((12, 20), True), ((5, 35), True), ((30, 33), True), ((31, 36), False)],
    ids=["just before", "its start", "within", "around", "its end", "just after"],
)


@marked
@pytest.mark.parametrize("agent", [1, None], ids=["named", "nearest"])
def test_a_found_segment_that_overlaps_a_marked_one_is_not_put(
    frames: tuple[int, int], wins: bool, agent: int | None
) -> None:
    node = SomClassifier(finding(tiny_model(), LIFT))
    marks = [mark("start", frames[0], agent=agent), mark("end", frames[1], agent=agent)]
    put = put_by(node, [*marks, *stream()])
    assert (bounds(LIFT) in found(put)) is not wins
    assert node.counters.counts == ({"found": 1, "marked": 1} if wins else {"found": 1, "told": 1})
    assert len([m for m in put if isinstance(m, Action) and m.final and m.segment_id == "hand"]) == 1


@pytest.mark.parametrize("agent", [1, None], ids=["named", "nearest"])
def test_while_a_segment_is_marked_nothing_is_said_of_what_goes_on_without_a_mark(agent: int | None) -> None:
    node = SomClassifier(finding(tiny_model(), LIFT))
    put = put_by(node, [mark("start", 20, agent=agent), *stream()])
    alone = [p.stamp_ns for p in partials(put) if p.segment_id != "hand"]
    assert alone == list(range(LIFT.start_ns, mark("start", 20).stamp_ns or 0, FRAME_NS))
    assert found(put) == []


def test_anothers_marks_hinder_nobody() -> None:
    put = put_by(SomClassifier(finding(tiny_model(), LIFT)), [mark("start", 5, agent=2), *stream(90, 2)])
    assert found(put) == [bounds(LIFT)]


def test_as_long_as_nobody_knows_whose_mark_it_is_it_may_be_anybodys() -> None:
    """The second person's postures are late, and that one may be the nearest."""
    people = stream(90, 2)
    first, second = ([p for p in people if p.agent == agent] for agent in (1, 2))
    node = SomClassifier(finding(tiny_model(), LIFT, PUSH))
    put = put_by(node, [mark("start", 5), mark("end", 35), *first[:50], *second, *first[50:]])
    assert bounds(LIFT) not in found(put)
    assert bounds(PUSH) in found(put)


def test_a_start_whose_end_was_forgotten_hinders_for_no_longer_than_a_segment_may_last() -> None:
    late_ns = START_NS + 61 * SECOND_NS
    late = SpottedSegment(late_ns + 10 * FRAME_NS, late_ns + 30 * FRAME_NS, "lift")
    node = SomClassifier(finding(tiny_model(), LIFT, late))
    put = put_by(node, [mark("start", 5, agent=1), *stream(), *stream(first_ns=late_ns)])
    assert [each for each in found(put) if each == bounds(LIFT)] == []
    assert bounds(late) in found(put)


def test_a_mark_that_comes_too_late_is_answered_beside_what_was_found() -> None:
    node = SomClassifier(finding(tiny_model(), LIFT))
    put = put_by(node, [*stream(), mark("start", 12), mark("end", 20)])
    assert [each[1:] for each in found(put)] == [
        (LIFT.start_ns, LIFT.end_ns),
        (START_NS + 12 * FRAME_NS, START_NS + 20 * FRAME_NS),
    ]


def test_with_marks_alone_nothing_is_searched() -> None:
    def refused(_: SpottingOptions) -> None:
        raise AssertionError("a search costs time")

    node = SomClassifier(spotting(tiny_model(), refused), segmentation=Segmentation("marks"))
    assert put_by(node, stream()) == []
    assert node.counters.state == "running"


def test_with_auto_alone_a_marked_segment_is_rejected_at_once_and_hides_nothing() -> None:
    node = SomClassifier(finding(tiny_model(), LIFT), segmentation=Segmentation("auto"))
    put = put_by(node, [mark("start", 5), mark("end", 35), *stream()])
    (rejected,) = [m for m in put if isinstance(m, Action) and not m.valid]
    assert put.index(rejected) == 0
    assert (rejected.segment_id, rejected.reason) == (mark("start", 5).segment_id, MARKS_OFF)
    assert found([m for m in put if m is not rejected]) == [bounds(LIFT)]
    assert node.counters.counts == {"marks_ignored": 2, "found": 1, "told": 1}


def test_a_segment_that_is_open_when_marks_are_switched_off_is_answered_by_its_end() -> None:
    node = SomClassifier.configured(Settings())
    first, *rest = (message for message in stream())
    node.handle(first)
    node.handle(mark("start", 5))
    (change,) = [each for each in node.commands if each.name == "set_parameters"]
    change.obey({"values": {"segments": "auto"}})
    answers = [answer for message in (*rest, mark("end", 35)) for answer in node.handle(message)]
    assert [answer.reason for answer in answers if isinstance(answer, Action) and answer.final] == ["no model"]


def likely(model: Model, segment: SpottedSegment) -> str:
    """The action that the model recognises in a segment, whatever its spotter takes it for."""
    put = put_by(SomClassifier(finding(model, segment)), stream())
    return next(str(m.action) for m in put if isinstance(m, Action) and m.final)


def test_what_the_user_does_not_want_told_is_counted() -> None:
    first, second = likely(tiny_model(), LIFT), likely(tiny_model(), PUSH)
    lift = SpottedSegment(LIFT.start_ns, LIFT.end_ns, first)
    push = SpottedSegment(PUSH.start_ns, PUSH.end_ns, second)

    def fates(options: SpottingOptions, enabled: frozenset[str] = frozenset()) -> dict[str, int]:
        node = SomClassifier(finding(tiny_model(), lift, push), segmentation=Segmentation("both", options, enabled))
        put = put_by(node, stream())
        told = {(m.segment_id, m.final) for m in put if isinstance(m, Action)}
        assert len({name for name, final in told if final}) == node.counters.counts["told"]
        kept = Counter(m.why for m in put if isinstance(m, HeldBack))
        assert kept + Counter(told=node.counters.counts["told"]) == node.counters.counts - Counter(found=2)
        assert not node.counters.rejects
        return dict(node.counters.counts)

    both = {"found": 2, "disabled": 2}
    assert fates(SpottingOptions(disabled=frozenset({first, second}))) == both
    assert fates(SpottingOptions(), enabled=frozenset({"none of them"})) == both
    assert fates(SpottingOptions(shortest_pause_s=1.0)) == {"found": 2, "told": 1, "pause": 1}
    assert fates(SpottingOptions(shortest_pause_s=0.1)) == {"found": 2, "told": 2}


def test_a_cooldown_goes_on_when_another_model_is_used() -> None:
    action = likely(tiny_model(), LIFT)
    same_again = SpottedSegment(PUSH.start_ns, PUSH.end_ns, action)
    assert likely(tiny_model(), PUSH) == action
    options = SpottingOptions(cooldown_s={action: 9.0})
    box = Box()
    node = SomClassifier(finding(tiny_model(), LIFT), box, segmentation=Segmentation("both", options))
    put = put_by(node, stream()[:38])
    box.model = finding(tiny_model(), same_again)
    put += put_by(node, [*[Tick(i) for i in range(POLL_TICKS)], *stream()[38:]])
    assert found(put) == [bounds(LIFT)]
    assert node.counters.counts == {"found": 2, "told": 1, "cooldown": 1}


def test_the_state_says_what_a_model_cannot() -> None:
    def state(model: Model, segmentation: Segmentation = DEFAULT) -> str:
        return SomClassifier(model, segmentation=segmentation).counters.state

    assert state(finding(tiny_model())) == "running"
    assert state(tiny_model()) == state(tiny_model(TINY_PAPER)) == f"running; {CANNOT}"
    assert state(tiny_model(), Segmentation("marks")) == "running"
    assert state(tiny_model(), Segmentation("auto")).startswith("nothing to do")
    assert state(finding(tiny_model(), background_s=0.0)) == f"running; {NO_BACKGROUND}"
    wrong = Segmentation(options=SpottingOptions(cooldown_s={"wvae": 3.0}, disabled=frozenset({"lift"})))
    assert state(finding(tiny_model()), wrong) == "settings name actions that the model does not know: wvae"


def test_a_model_that_cannot_search_answers_marks_as_ever() -> None:
    put = put_by(SomClassifier(tiny_model()), [mark("start", 10), mark("end", 30), *stream()])
    assert found(put) == [bounds(LIFT)]
    assert all(isinstance(m, Action) for m in put)


def test_the_same_stream_gives_the_same_to_the_last_bit_live_and_replayed() -> None:
    model = beating(tiny_model())
    replayed = replay(SomClassifier(model), [(p.stamp_ns, p) for p in stream(90, 2)])
    live = put_by(SomClassifier(model), stream(90, 2))
    assert list(map(packed, map(_unnumbered, replayed))) == list(map(packed, map(_unnumbered, live)))


def _unnumbered(message: Message) -> Message:
    return message.model_copy(update={"seq": None})


CHANGES: tuple[dict[str, object], ...] = (
    {"publish_maps": True}, {"cooldown_s": {"swing": 3.0}}, {"disabled_actions": ["swing"]},
    {"enabled_actions": ["lift", "push"]}, {"false_alarms_per_min": 2.5}, {"shortest_pause_s": 0.1},
    {"segments": "auto"}, {"segments": "auto", "false_alarms_per_min": 0.1, "publish_maps": True},
)  # fmt: skip


def asked(node: SomClassifier, **values: object) -> None:
    {command.name: command for command in node.commands}["set_parameters"].obey({"values": values})


def found_with_changes(changes: dict[int, list[dict[str, object]]]) -> list[tuple[int, int, int]]:
    """What is found of three actions, one in each second, where settings are changed before some frames."""
    node = SomClassifier.configured(Settings())
    node._use(beating(tiny_model()))

    def frames() -> Iterator[Posture]:
        for number, posture in enumerate(stream()):
            for values in changes.get(number, ()):
                asked(node, **values)
            yield posture

    return found(put_by(node, frames()))


@pytest.mark.parametrize("values", CHANGES, ids=",".join)
def test_an_action_in_whose_middle_a_setting_is_changed_is_found_as_if_nothing_had_been(
    values: dict[str, object],
) -> None:
    undisturbed = found_with_changes({})
    assert len(undisturbed) == 3
    for at_frame in (1, 15, 27, 45):
        assert found_with_changes({at_frame: [values]}) == undisturbed


def test_what_is_switched_off_and_on_again_in_the_middle_of_an_action_is_found() -> None:
    off, on = {"disabled_actions": ["lift"]}, {"disabled_actions": []}
    assert found_with_changes({15: [off], 20: [on]}) == found_with_changes({})


def test_where_found_actions_are_not_wanted_any_more_none_is_told_and_then_again_some_are() -> None:
    told = found_with_changes({15: [{"segments": "marks"}], 45: [{"segments": "both"}]})
    assert told == found_with_changes({})[2:]
