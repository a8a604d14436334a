"""However long a stream runs, and however many people come and go, no node holds more than a segment may need."""

import tracemalloc
from collections.abc import Iterator

import pytest

from actum.messages import Action, Agent, Message, Posture, Segment, Skeleton
from actum.node import SECOND_NS, TICK_NS, Node, Tick
from node_cases import ALL_CASES, CLASSIFIER, NOON_NS, Case

MINUTE_S = 60
FILLED_S = 70
LENGTH_S = 3 * MINUTE_S
RATE_HZ = 3


def minutes(case: Case, from_s: int, to_s: int, renumbered: bool) -> Iterator[Message | Tick]:
    """The streams of the task over and over, with ticks between; people renumbered every second if so."""
    samples = [m for m in case.messages() if not isinstance(m, Segment | Action)]
    kinds = {type(m): [s for s in samples if type(s) is type(m)] for m in samples}
    for i in range(from_s * RATE_HZ, to_s * RATE_HZ):
        stamp_ns = NOON_NS + i * SECOND_NS // RATE_HZ
        person = 1 + (i // RATE_HZ if renumbered else 0)
        yield Tick(i * SECOND_NS // RATE_HZ // TICK_NS * TICK_NS)
        for of_kind in kinds.values():
            yield of_person(of_kind[i % len(of_kind)], person).model_copy(update={"stamp_ns": stamp_ns})


def of_person(message: Message, person: int) -> Message:
    if isinstance(message, Posture):
        return message.model_copy(update={"agent": person, "agents": [person]})
    if isinstance(message, Skeleton):
        (agent,) = message.agents
        return message.model_copy(update={"agents": [Agent(**agent.model_dump() | {"agent": person})]})
    return message


def held_after(node: Node, messages: Iterator[Message | Tick]) -> int:
    """Bytes allocated when all has been handled."""
    for message in messages:
        for _ in node.handle(message):
            pass
    return tracemalloc.get_traced_memory()[0]


@pytest.fixture
def traced() -> Iterator[None]:
    tracemalloc.start()
    yield
    tracemalloc.stop()


@pytest.mark.parametrize(
    ("case", "renumbered"),
    [pytest.param(case, False, marks=pytest.mark.thorough) for case in ALL_CASES]
    + [(case, True) for case in ALL_CASES if case.name != "marker_tracker"],
    ids=lambda value: {False: "one person", True: "renumbered every second"}.get(value) or repr(value),
)
@pytest.mark.usefixtures("traced")
def test_three_minutes_hold_no_more_than_the_first(case: Case, renumbered: bool) -> None:
    node = case.build()
    begun = tracemalloc.get_traced_memory()[0]
    filled = held_after(node, minutes(case, 0, FILLED_S, renumbered)) - begun
    later = held_after(node, minutes(case, FILLED_S, LENGTH_S, renumbered)) - begun
    assert later < 1.2 * filled + 100_000


@pytest.mark.usefixtures("traced")
def test_starts_that_are_never_ended_are_let_go() -> None:
    """Each is answered; its id is kept for a while, to know it again."""
    node = CLASSIFIER.build()
    begun = tracemalloc.get_traced_memory()[0]
    answered = 0
    for i in range(500):
        start = Segment(stamp_ns=2**61, sensor="kinect0", kind="start", segment_id=f"never-{i}")
        answered += len([*node.handle(start), *node.handle(Tick(i * SECOND_NS))])
    assert answered > 400
    assert tracemalloc.get_traced_memory()[0] - begun < 500_000
