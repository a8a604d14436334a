"""Signals that ask a process to end."""

import signal
from collections.abc import Iterator

import pytest

from actum.runtime import stop_on_signals

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
