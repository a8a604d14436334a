"""Threads get their turns in the order in which they ask for them, one at a time."""

from threading import Thread

from actum.runtime.turns import Turns
from live import wait_until


def test_a_thread_that_asks_again_at_once_gets_its_turn_after_those_that_wait() -> None:
    turns, order = Turns(), list[str]()

    def take(name: str) -> None:
        with turns:
            order.append(name)

    threads = [Thread(target=take, args=(name,)) for name in ("first", "second")]
    with turns:
        for waiting, thread in enumerate(threads, start=1):
            thread.start()
            wait_until(lambda waiting=waiting: len(turns._waiting) == waiting, "the thread waits")
        assert order == []
    take("again")
    for thread in threads:
        thread.join(10)
    assert order == ["first", "second", "again"]


def test_a_turn_ends_with_an_exception() -> None:
    turns = Turns()
    try:
        with turns:
            raise ValueError
    except ValueError:
        pass
    with turns:
        pass
