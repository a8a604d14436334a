"""Where the time goes: every hop as a process that receives cause and effect measures it, by its one clock."""

import pytest

from actum.hops import MINUTE_S, MOST_WAITING, SETTLING_NS, SHORTEST_MS, STEP, Hops
from actum.messages import AUTO, MANUAL, Action, HopTime, Message, Posture
from actum.node import SECOND_NS
from empty_messages import action, image, mark, skeleton
from events import event
from node_cases import PREPROCESSOR

MILLISECOND_NS = 1_000_000
WITHIN = STEP - 1


class Receiving:
    """A process whose clock a test sets, when nothing that was kept of before comes any more."""

    def __init__(self) -> None:
        self.now_ns = 10**15
        self._hops = Hops(lambda: self.now_ns)
        self._hops.receive(skeleton(0))
        self.wait(SETTLING_NS)

    def wait(self, for_ns: int) -> None:
        self.now_ns += for_ns

    def receive(self, message: Message, after_ms: float = 0.0) -> None:
        self.wait(round(after_ms * MILLISECOND_NS))
        self._hops.receive(message)

    def times(self) -> dict[str, HopTime]:
        return {f"{each.cause} → {each.effect}": each for each in self._hops.times()}


@pytest.fixture
def receiving() -> Receiving:
    return Receiving()


@pytest.fixture(scope="module")
def posture() -> Posture:
    node = PREPROCESSOR.build()
    answers = [answer for message in PREPROCESSOR.messages() for answer in node.handle(message)]
    return next(answer for answer in answers if isinstance(answer, Posture))


def of(posture: Posture, stamp_ns: int, agent: int = 1) -> Posture:
    return posture.model_copy(update={"stamp_ns": stamp_ns, "agent": agent})


def partial(stamp_ns: int, agent: int = 1) -> Action:
    return action(0, None, final=False).model_copy(update={"stamp_ns": stamp_ns, "agent": agent})


def test_of_delays_from_1_to_100_ms_the_percentiles_are_50_and_99_ms(receiving: Receiving, posture: Posture) -> None:
    for delay_ms in range(1, 101):
        receiving.receive(skeleton(delay_ms))
        receiving.receive(of(posture, delay_ms), after_ms=delay_ms)
    [found] = receiving.times().values()
    assert (found.cause, found.effect, found.count) == ("skeleton", "posture", 100)
    assert (found.p50_ms, found.p99_ms) == (pytest.approx(50, rel=WITHIN), pytest.approx(99, rel=WITHIN))


def test_every_hop_of_a_marked_action_is_measured_by_itself(receiving: Receiving, posture: Posture) -> None:
    receiving.receive(image(7))
    receiving.receive(skeleton(7), after_ms=20)
    receiving.receive(of(posture, 7), after_ms=2)
    receiving.receive(partial(7), after_ms=3)
    receiving.receive(mark("end", 9, origin=MANUAL), after_ms=50)
    receiving.receive(action(1, 9), after_ms=5)
    receiving.receive(event("one", "push the cup"), after_ms=40)
    assert {name: each.p50_ms for name, each in receiving.times().items()} == {
        "image → skeleton": pytest.approx(20, rel=WITHIN),
        "skeleton → posture": pytest.approx(2, rel=WITHIN),
        "posture → partial action": pytest.approx(3, rel=WITHIN),
        "end mark → final action": pytest.approx(5, rel=WITHIN),
        "final action → event": pytest.approx(40, rel=WITHIN),
        "end mark → event": pytest.approx(45, rel=WITHIN),
    }


def test_each_persons_partial_action_follows_from_that_persons_posture(receiving: Receiving, posture: Posture) -> None:
    for agent in (1, 2):
        receiving.receive(of(posture, 5, agent), after_ms=4)
    receiving.receive(partial(5, agent=2), after_ms=1)
    receiving.receive(partial(5, agent=1), after_ms=1)
    receiving.receive(partial(5, agent=3), after_ms=1)
    found = receiving.times()["posture → partial action"]
    assert (found.count, found.p50_ms, found.p99_ms) == (
        2,
        pytest.approx(1, rel=WITHIN),
        pytest.approx(6, rel=WITHIN),
    )


def test_an_effect_that_is_read_before_its_cause_by_another_thread_has_taken_no_time(
    receiving: Receiving, posture: Posture
) -> None:
    receiving.receive(of(posture, 3))
    receiving.receive(skeleton(3), after_ms=0.2)
    found = receiving.times()["skeleton → posture"]
    assert (found.count, found.p99_ms) == (1, SHORTEST_MS)


def test_an_end_mark_that_comes_long_after_its_segment_was_answered_has_not_caused_the_answer(
    receiving: Receiving,
) -> None:
    receiving.receive(action(1, 9))
    receiving.receive(mark("end", 9), after_ms=5_000)
    assert receiving.times() == {}


def test_the_end_of_a_segment_that_the_classifier_found_is_no_cause(receiving: Receiving) -> None:
    receiving.receive(mark("end", 9, origin=AUTO))
    receiving.receive(action(1, 9), after_ms=5)
    assert receiving.times() == {}


def test_what_is_older_than_a_minute_does_not_count(receiving: Receiving, posture: Posture) -> None:
    def take(stamp_ns: int, delay_ms: float) -> None:
        receiving.receive(skeleton(stamp_ns))
        receiving.receive(of(posture, stamp_ns), after_ms=delay_ms)

    take(1, 500)
    receiving.wait(30 * SECOND_NS)
    take(2, 2)
    assert receiving.times()["skeleton → posture"].p99_ms == pytest.approx(500, rel=WITHIN)
    receiving.wait((MINUTE_S - 30) * SECOND_NS)
    found = receiving.times()["skeleton → posture"]
    assert (found.count, found.p99_ms) == (1, pytest.approx(2, rel=WITHIN))
    receiving.wait(1000 * MINUTE_S * SECOND_NS)
    assert receiving.times() == {}


def test_what_was_kept_of_before_the_start_and_comes_at_once_is_not_measured() -> None:
    clock_ns = iter(range(0, SECOND_NS, MILLISECOND_NS))
    hops = Hops(lambda: next(clock_ns))
    for message in (mark("end", 9), action(1, 9), event("one", "push the cup")):
        hops.receive(message)
    assert hops.times() == []


def test_causes_that_nothing_follows_do_not_fill_the_memory(receiving: Receiving, posture: Posture) -> None:
    for stamp_ns in range(MOST_WAITING + 1):
        receiving.receive(skeleton(stamp_ns))
    receiving.receive(of(posture, 0), after_ms=1)
    assert receiving.times() == {}, "the oldest was forgotten"
    receiving.receive(of(posture, 1), after_ms=1)
    assert receiving.times()["skeleton → posture"].count == 1, "and no other"


def test_effects_that_nothing_has_caused_do_not_fill_the_memory(receiving: Receiving, posture: Posture) -> None:
    for stamp_ns in range(MOST_WAITING + 1):
        receiving.receive(of(posture, stamp_ns))
    for stamp_ns in range(MOST_WAITING + 1):
        receiving.receive(skeleton(stamp_ns))
    assert receiving.times()["skeleton → posture"].count == MOST_WAITING


def test_a_delay_longer_than_any_counts_as_the_longest(receiving: Receiving) -> None:
    receiving.receive(mark("end", 9))
    receiving.receive(action(1, 9), after_ms=3_600_000)
    assert receiving.times()["end mark → final action"].p99_ms > 60_000
