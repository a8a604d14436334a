"""A lock that threads get in the order in which they ask for it."""

import threading
from collections import deque


class Turns:
    """Only one thread has the turn. It passes the turn on to the thread that has waited for longest.

    A thread that asks again at once waits behind the others. A `threading.Lock` would mostly give it the lock again,
    because those that wait have to be woken up first.
    """

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._is_taken = False
        self._waiting: deque[threading.Lock] = deque()

    def __enter__(self) -> None:
        with self._changing:
            if not self._is_taken:
                self._is_taken = True
                return
            own = threading.Lock()
            own.acquire()
            self._waiting.append(own)
        own.acquire()

    def __exit__(self, *_: object) -> None:
        with self._changing:
            if self._waiting:
                self._waiting.popleft().release()
            else:
                self._is_taken = False
