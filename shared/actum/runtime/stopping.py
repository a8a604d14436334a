"""How a process ends: by a signal, or with its parent process; and waits that the end of the process cuts short."""

import _thread
import os
import signal
import threading
import time

from actum.node import SETTLE_NS

PARENT = "ACTUM_PARENT"
"""The environment variable with the id of the parent process that this one is to end with."""
LOOK_S = 0.5
"""Interval (s) at which the parent is checked."""
LEAVE_S = 5.0
"""How long (s) a clean end may take after SIGTERM; then the process is ended at once."""
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


def end_with_parent() -> None:
    """Send this process SIGTERM once its parent is not the one that `ACTUM_PARENT` names, if that is set."""
    parent = os.environ.get(PARENT, "")

    def watch() -> None:
        while os.getppid() == int(parent):
            time.sleep(LOOK_S)
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(LEAVE_S)
        os._exit(1)

    if parent.isdecimal():
        threading.Thread(target=watch, daemon=True).start()


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
