"""What every node puts: the same for the same input, nothing for what is not meant for it, on documented keys."""

import random
import re

from hypothesis import given, settings
from hypothesis import strategies as st

from actum import codec, keys, messages
from actum.messages import Continuation, HeldBack, Info, Intent, Message, Status, Training, Truth
from actum.node import SECOND_NS, TICK_NS, Tick
from node_cases import CASES, Case, every_node_finding_too
from wire import Wire, packed

HEALTH = {"stamp_ns": 1, "sensor": "kinect0", "service": "x", "instance": "y"}
STRANGERS: tuple[Message, ...] = (
    Truth(
        stamp_ns=1, sensor="kinect0", kind="start", segment_id="s", agent=1, hand="left", action="lift", object_id=1,
        object_name="cup", displacement_m=None,
    ),
    HeldBack(
        stamp_ns=1, sensor="kinect0", agent=1, start_ns=0, end_ns=1, action="lift", confidence=0.5, familiarity=0.1,
        why="unknown", sentence="like lift, but not like enough: 0.10",
    ),
    Intent(stamp_ns=1, sensor="kinect0", agent=1, intended=[]),
    Continuation(stamp_ns=1, sensor="kinect0", agent=1, ahead=[]),
    Info.model_validate(HEALTH | {"version": "1", "schemas": [], "joint_names": []}),
    Status.model_validate(
        HEALTH
        | {"uptime_s": 1.0, "rates": {}, "handled": {}, "drops": {}, "rejects": {}, "last_error": None}
        | {"latency_ms": {}, "state": "running"}
    ),
    Training(stamp_ns=1, sensor="kinect0", recording=None, job=None, model=None, can_undo=False, revision=0),
)  # fmt: skip


@every_node_finding_too
def test_it_puts_on_its_own_keys(case: Case) -> None:
    outputs = Wire(case.build()).send(*case.messages())
    assert bool(outputs) == bool(case.puts)
    assert all(re.fullmatch(case.puts, keys.key_of(output)) for output in outputs)


@every_node_finding_too
def test_what_it_puts_unchecked_would_pass_the_check(case: Case) -> None:
    """A step may build its messages without checks: they are those that the classes make, fields in the same order."""
    node = case.build()
    outputs = [output for message in case.messages() for output in node.handle(message)]
    for output in outputs:
        checked = type(output).model_validate(output.model_dump())
        assert (checked, list(vars(checked))) == (output, list(vars(output)))
        assert codec.encode(checked, seq=1) == codec.encode(output, seq=1)


@every_node_finding_too
@settings(max_examples=10)
@given(seed=st.integers(), share=st.floats(0.5, 1.0))
def test_the_same_input_gives_the_same_output_to_the_last_bit(case: Case, seed: int, share: float) -> None:
    """In any order, with ticks between, and with some of it missing."""
    rng = random.Random(seed)
    items: list[Message | Tick] = [m for m in case.messages() if rng.random() < share]
    items += [Tick(i * TICK_NS) for i in range(10)]
    rng.shuffle(items)

    def outputs() -> list[bytes]:
        wire = Wire(case.build())
        return [packed(output) for item in items for output in wire.handle(item)]

    assert outputs() == outputs()


@every_node_finding_too
def test_what_is_not_meant_for_it_is_met_with_silence(case: Case) -> None:
    taken = tuple(topic.message for topic in case.build().inputs)
    foreign = [m for other in CASES for m in other.one_of_each() if not isinstance(m, taken)] + list(STRANGERS)
    assert {type(m) for m in foreign} | set(taken) >= set(messages.MESSAGES) - {messages.Event}
    disturbed, alone = Wire(case.build()), Wire(case.build())
    outputs = [disturbed.handle(m) for m in foreign]
    assert not any(outputs)
    assert list(map(packed, disturbed.send(*case.messages()))) == list(map(packed, alone.send(*case.messages())))


@every_node_finding_too
def test_idle_ticks_by_the_thousand_change_nothing(case: Case) -> None:
    ticked, alone = Wire(case.build()), Wire(case.build())
    assert not any(ticked.handle(Tick(i)) for i in range(0, 10**4 * TICK_NS, TICK_NS))
    assert not any(ticked.handle(Tick(i)) for i in (0, 2**62, 0, 5 * SECOND_NS))
    assert list(map(packed, ticked.send(*case.messages()))) == list(map(packed, alone.send(*case.messages())))
