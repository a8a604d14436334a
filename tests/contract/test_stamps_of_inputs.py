"""Stamps that repeat, fall or are absurd: each stream's time rises, and no single stamp can end a stream."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import Action, Message, Posture, Segment
from actum.node import SECOND_NS, Tick
from node_cases import CASES, NOON_NS, SCENE, Case, every_node, later
from people import FRAME_NS
from wire import Wire, lasting, without_seq

FAR_NS = 62 * SECOND_NS
"""Beyond this a stamp belongs to no segment that may still be open."""

every_stream = pytest.mark.parametrize(
    ("case", "message"),
    [
        pytest.param(case, message, id=f"{case}-{message.SCHEMA}")
        for case in CASES
        for message in case.one_of_each()
        if not isinstance(message, Segment | Action)
    ],
)


def stamped(message: Message, stamp_ns: int) -> Message:
    return message.model_copy(update={"stamp_ns": stamp_ns})


@every_stream
@pytest.mark.parametrize("back_ns", [0, 1, FRAME_NS, 60 * SECOND_NS])
def test_a_repeated_or_older_stamp_is_counted_and_changes_nothing(case: Case, message: Message, back_ns: int) -> None:
    wire = Wire(case.build())
    wire.send(message)
    assert wire.send(stamped(message, message.stamp_ns - back_ns)) == []
    assert wire.node.counters.rejects == {"stale_stamp": 1}


@every_stream
def test_time_that_runs_backwards_is_counted_until_it_is_taken_for_a_new_start(case: Case, message: Message) -> None:
    wire = Wire(case.build())
    wire.send(message)
    for i in range(10):
        wire.send(stamped(message, message.stamp_ns - FAR_NS - i))
    assert wire.node.counters.rejects == {"stale_stamp": 10}
    for i in range(4):
        wire.send(stamped(message, message.stamp_ns - 2 * FAR_NS + i))
    assert wire.node.counters.rejects["stale_stamp"] == 12


@every_node
@settings(max_examples=8)
@given(
    ahead_ns=st.integers(FAR_NS + 10 * SECOND_NS, 2**62 - 1 - NOON_NS) | st.just(2**62 - 1 - NOON_NS), data=st.data()
)
def test_after_stamps_far_ahead_each_stream_goes_on_with_its_fourth_message(
    case: Case, ahead_ns: int, data: st.DataObject
) -> None:
    def answers(wire: Wire) -> list[bytes]:
        wire.send(*case.warm_up(NOON_NS, "task"))
        return lasting([m for m in wire.send(*case.task(NOON_NS, "task")) if case.wanted(m, "task")])

    wire = Wire(case.build())
    before = case.messages(NOON_NS - 10 * SECOND_NS, "before")
    ahead = [stamped(message, NOON_NS + ahead_ns) for message in case.one_of_each() if not isinstance(message, Action)]
    split = data.draw(st.integers(0, len(before)))
    wire.send(*before[:split], *ahead, *before[split:])
    assert answers(wire) == answers(Wire(case.build()))


@every_node
@pytest.mark.parametrize("first_ns", [0, 2**62 - 10 * SECOND_NS])
def test_stamps_at_the_ends_of_their_range_are_as_good_as_any(case: Case, first_ns: int) -> None:
    def answers(begin_ns: int) -> list[bytes]:
        outputs = Wire(case.build()).send(*case.messages(begin_ns + 2 * SECOND_NS))
        return without_seq(later(outputs, -begin_ns))

    assert answers(first_ns) == answers(NOON_NS)


CLASSIFIER, FUSION = CASES[1], CASES[3]


@pytest.mark.parametrize("case", [CLASSIFIER, FUSION], ids=repr)
def test_absurd_stamps_on_strangers_keys_leave_the_others_alone(case: Case) -> None:
    """Two people are heard between each other, after a crowd whose clock is wrong."""
    crowd = [SCENE.posture(0.0, agent=agent, stamp_ns=2**62 - 1) for agent in range(100, 120)]
    messages: list[Message] = []
    for message in case.messages():
        second = [message.model_copy(update={"agent": 2})] if isinstance(message, Posture) else []
        messages += [*second, message]
    outputs, alone = (
        [m for m in Wire(case.build()).send(*sent) if case.wanted(m, "task")]
        for sent in ([*crowd, *messages], messages)
    )
    assert without_seq(outputs) == without_seq(alone) != []
    assert all(output.valid for output in outputs)


@pytest.mark.parametrize("case", [CLASSIFIER, FUSION], ids=repr)
def test_a_segment_far_ahead_does_not_make_everything_after_it_late(case: Case) -> None:
    wire = Wire(case.build())
    wire.send(*case.warm_up(NOON_NS - SECOND_NS, "task"))
    ahead = [m for m in case.messages(2**61, "ahead") if isinstance(m, Action | Segment)]
    wire.send(*(m.model_copy(update={"agent": 1}) for m in ahead))
    answered = [output for i in range(130) for output in wire.handle(Tick(i * SECOND_NS // 10))]
    assert [output.segment_id for output in answered] == ["ahead"]
    wire.send(*case.messages())
    assert set(wire.node.counters.rejects) <= {"rejected_segment"}
