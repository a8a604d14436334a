"""Signals end a process. Messages are paced by their stamps, and a wrong stamp makes nobody wait for years."""

import signal
import threading
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS, SETTLE_NS
from actum.runtime import Pace, stop_on_signals, stopping

SIGNALS = (signal.SIGTERM, signal.SIGINT)


@pytest.fixture
def handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.timeout(10)
def test_a_signal_is_heeded_even_while_the_main_thread_holds_the_events_lock(handlers, number):
    stop = stop_on_signals()
    with stop._cond:
        signal.raise_signal(number)
    assert stop.wait(5)


class Clock:
    """Time that passes by waiting alone."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_ns = 10**15
        monkeypatch.setattr(stopping.time, "monotonic_ns", lambda: self.now_ns)
        monkeypatch.setattr(stopping, "wait_for", self._pass)

    def _pass(self, _: threading.Event, seconds: float) -> bool:
        self.now_ns += max(round(seconds * 1e9), 0)
        return False


def waited_s(stamps_ns: list[int], speed: float = 1.0) -> list[float]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        clock, pace, waited = Clock(monkeypatch), Pace(speed), []
        for stamp_ns in stamps_ns:
            before_ns = clock.now_ns
            assert pace.wait(stamp_ns, threading.Event())
            waited.append((clock.now_ns - before_ns) / 1e9)
    return waited


def test_stamps_are_waited_for_at_a_multiple_of_their_pace() -> None:
    assert waited_s([5 * SECOND_NS, 6 * SECOND_NS, 10 * SECOND_NS], 2.0) == pytest.approx([0, 0.5, 2], abs=1e-6)


@given(st.lists(st.integers(0, 2**62 - 1), min_size=1, max_size=8))
def test_no_wait_is_longer_than_anything_waits(stamps_ns: list[int]) -> None:
    assert max(waited_s(stamps_ns)) <= SETTLE_NS / SECOND_NS + 1e-3
