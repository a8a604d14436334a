"""Messages are paced by their stamps; a wrong stamp makes nobody wait for years."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS, SETTLE_NS
from actum.runtime import waiting
from actum.runtime.waiting import Pace


class Clock:
    """Time that passes by waiting alone."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_ns = 10**15
        monkeypatch.setattr(waiting.time, "monotonic_ns", lambda: self.now_ns)
        monkeypatch.setattr(waiting, "wait_for", self._pass)

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
