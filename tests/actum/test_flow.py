from hypothesis import given
from hypothesis import strategies as st

from actum.flow import PATIENCE_NS, STILL_NS, Flow
from actum.node import SECOND_NS, TICK_NS

WAIT_NS = 2 * SECOND_NS


def ticked(flow: Flow, from_s: float, to_s: float) -> int:
    """Let time go on; return the last tick."""
    ticks = range(round(from_s * 10), round(to_s * 10) + 1)
    for tick in ticks:
        flow.tick(tick * TICK_NS)
    return ticks[-1] * TICK_NS


def test_a_stream_that_goes_on_is_waited_for_as_long_as_it_may_lag() -> None:
    flow = Flow()
    for tenth in range(100):
        flow.note()
        now_ns = ticked(flow, tenth / 10, tenth / 10)
        assert flow.ended(0, WAIT_NS) == (now_ns >= WAIT_NS)


def test_one_that_never_came_is_waited_for_no_longer() -> None:
    flow = Flow()
    ticked(flow, 0.0, 1.9)
    assert not flow.ended(0, WAIT_NS)
    ticked(flow, 2.0, 2.0)
    assert flow.ended(0, WAIT_NS)


def test_one_that_stands_still_is_waited_for_until_it_must_have_ended() -> None:
    flow = Flow()
    flow.note()
    ticked(flow, 0.0, PATIENCE_NS / SECOND_NS)
    assert not flow.ended(0, WAIT_NS)
    ticked(flow, PATIENCE_NS / SECOND_NS + 0.1, PATIENCE_NS / SECOND_NS + 0.1)
    assert flow.ended(0, WAIT_NS)


def test_one_that_comes_again_is_given_the_time_to_come_up() -> None:
    flow = Flow()
    flow.note()
    ticked(flow, 0.0, 5.0)
    flow.note()
    ticked(flow, 5.1, 5.1)
    for tenth in range(52, 70):
        flow.note()
        ticked(flow, tenth / 10, tenth / 10)
        assert not flow.ended(0, WAIT_NS)
    flow.note()
    ticked(flow, 7.1, 7.1)
    assert flow.ended(0, WAIT_NS)


def test_one_that_is_expected_stands_still_from_the_start() -> None:
    flow = Flow()
    flow.expect()
    ticked(flow, 0.1, 5.0)
    assert not flow.ended(SECOND_NS // 10, WAIT_NS)


@given(st.lists(st.booleans(), min_size=200, max_size=200))
def test_whatever_comes_nothing_is_awaited_for_longer_than_both(arrivals: list[bool]) -> None:
    flow = Flow()
    for tenth, arrives in enumerate(arrivals):
        if arrives:
            flow.note()
        ticked(flow, tenth / 10, tenth / 10)
    assert flow.ended(0, WAIT_NS)
    assert STILL_NS < WAIT_NS
