from hypothesis import given
from hypothesis import strategies as st

from actum.stamps import RESTART_BEHIND_NS, LostFrames, Order, StampGuard


@given(st.lists(st.integers(0, 10**10)))
def test_only_rising_stamps_pass_within_a_segments_reach(stamps: list[int]) -> None:
    guard = StampGuard()
    passed = [stamp for stamp in stamps if guard.judge(stamp) is Order.NEXT]
    assert passed == sorted(set(passed))
    assert (passed[-1] if passed else None) == (max(stamps) if stamps else None)


def test_a_changed_session_is_a_restart_at_any_stamp() -> None:
    guard = StampGuard()
    assert guard.judge(100, "a") is Order.NEXT
    assert guard.judge(50, "b") is Order.RESTART
    assert guard.judge(60, "b") is Order.NEXT


def test_one_absurd_stamp_does_not_end_the_stream() -> None:
    guard = StampGuard()
    guard.judge(1_000)
    guard.judge(1_000 + 10 * RESTART_BEHIND_NS)
    orders = [guard.judge(stamp) for stamp in (2_000, 3_000, 4_000, 5_000)]
    assert orders == [Order.STALE, Order.STALE, Order.RESTART, Order.NEXT]


def test_numbers_tell_what_was_lost_in_between_unless_they_are_unknown_or_begin_anew() -> None:
    lost = LostFrames()
    assert [lost.before(seq, Order.NEXT) for seq in (7, 8, 11, 12)] == [0, 0, 2, 0]
    assert lost.before(100, Order.RESTART) == 0
    assert [lost.before(seq, Order.NEXT) for seq in (None, 200, 150)] == [0, 0, 0]
