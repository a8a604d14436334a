"""A replay of a node costs what its messages cost, whatever their stamps say."""

from itertools import islice, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum import keys
from actum.messages import Message
from actum.node import SECOND_NS, SETTLE_NS, TICK_NS, Counters, Tick, replay
from people import FRAME_NS, STANDING, skeleton

NOW_NS = 1_790_000_000 * SECOND_NS
MOST_TICKS = 10_000


class Listener:
    """Notes what it is handed, and refuses more ticks than any test needs."""

    name = "listener"
    inputs = (keys.SKELETON,)

    def __init__(self) -> None:
        self.counters = Counters()
        self.taken: list[Message] = []
        self.ticks_ns: list[int] = []

    def handle(self, message: Message | Tick) -> list[Message]:
        if isinstance(message, Tick):
            self.ticks_ns.append(message.monotonic_ns)
            assert len(self.ticks_ns) < MOST_TICKS, "ticks without end"
        else:
            self.taken.append(message)
        return []


def replayed(*stamps_ns: int) -> Listener:
    node = Listener()
    assert list(replay(node, [(stamp_ns, skeleton(stamp_ns, STANDING)) for stamp_ns in stamps_ns])) == []
    return node


@pytest.mark.parametrize(
    "stamps_ns",
    [
        [0, NOW_NS],
        [1_790_000_000, NOW_NS, NOW_NS + FRAME_NS],
        [NOW_NS, NOW_NS + FRAME_NS, 2**62 - 1],
        [NOW_NS, 2**62 - 1, NOW_NS + FRAME_NS],
        [NOW_NS, 0, NOW_NS + FRAME_NS],
        [0, 1, NOW_NS, 2],
    ],
)
def test_one_wrong_stamp_costs_few_ticks(stamps_ns: list[int]) -> None:
    node = replayed(*stamps_ns)
    assert [message.stamp_ns for message in node.taken] == stamps_ns
    assert len(node.ticks_ns) <= (len(stamps_ns) + 1) * (SETTLE_NS // TICK_NS + 1)


@given(st.lists(st.integers(0, 2**62 - 1), min_size=1, max_size=8))
def test_ticks_go_on_without_a_leap_whatever_the_stamps_are(stamps_ns: list[int]) -> None:
    ticks_ns = replayed(*stamps_ns).ticks_ns
    assert all(after - before == TICK_NS for before, after in pairwise(ticks_ns))


def test_everything_that_waits_is_over_after_a_gap() -> None:
    node = Listener()
    list(islice(replay(node, [(stamp_ns, skeleton(stamp_ns, STANDING)) for stamp_ns in (5, NOW_NS)], settle_ns=0), 9))
    assert node.ticks_ns[-1] - node.ticks_ns[0] >= SETTLE_NS - TICK_NS


def test_ticks_stand_at_the_stamps_where_no_gap_is_long() -> None:
    ticks_ns = replayed(NOW_NS, NOW_NS + SECOND_NS).ticks_ns
    assert ticks_ns[:11] == [NOW_NS + number * TICK_NS for number in range(11)]
