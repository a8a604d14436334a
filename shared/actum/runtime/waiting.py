"""Waits that a signal ends: for a duration, or until a stamp is due."""

import _thread
import signal
import threading
import time

from actum.node import SETTLE_NS

SLICE_S = 0.1
"""How late (s) a signal may be noticed."""


def stop_on_signals() -> threading.Event:
    """Return an event that SIGTERM and SIGINT set.

    A thread of its own sets it: a handler runs in the main thread, perhaps while that holds the event's lock.
    """
    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: _thread.start_new_thread(stop.set, ()))
    return stop


def wait_for(stop: threading.Event, seconds: float = float("inf")) -> bool:
    """Wait until stopped, at most for `seconds`; True if stopped.

    The wait is cut into slices: a signal that the kernel delivers to one of Zenoh's threads does not end a wait of
    the main thread, where alone Python runs the handler.
    """
    deadline_s = time.monotonic() + seconds
    while (left_s := deadline_s - time.monotonic()) > 0:
        if stop.wait(min(left_s, SLICE_S)):
            return True
    return stop.is_set()


class Pace:
    """Paces messages by their stamps, at the speed at which they were captured or a multiple of it.

    A gap between two stamps is waited out for `SETTLE_NS` at the most: one wrong stamp would mean years.
    """

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._newest: tuple[int, float] | None = None

    def wait(self, stamp_ns: int, stop: threading.Event) -> bool:
        """Wait until the stamp is due; False if stopped meanwhile."""
        if self._newest is None:
            self._newest = stamp_ns, time.monotonic_ns()
        newest_ns, due_ns = self._newest
        if stamp_ns > newest_ns:
            due_ns += min((stamp_ns - newest_ns) / self._speed, SETTLE_NS)
            self._newest = stamp_ns, due_ns
        return not wait_for(stop, (due_ns - time.monotonic_ns()) / 1e9)
