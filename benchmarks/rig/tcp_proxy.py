"""A TCP proxy that puts delay, jitter, stalls and cuts on a link."""

import collections
import contextlib
import random
import socket
import struct
import threading
import time
from types import TracebackType
from typing import Self

READ_BYTES = 65_536
"""Read at once: more would let a chunk hold many messages, of which each would have its own delay on a network."""
IN_FLIGHT_BYTES = 4_000_000
"""Held in each direction of a connection: what a gigabit link with 30 ms of delay has on its way."""
CONNECT_S = 5.0
"""How long the target may take to accept (s)."""
RESET = struct.pack("ii", 1, 0)
"""SO_LINGER on with no time: close() sends RST, as a host does that has forgotten a connection."""


class TcpProxy:
    """Forwards TCP connections to a target, each byte once and in order, as late as it is told.

    Args:
        target_port, target_host: where connections lead.
        port, host: where it listens; port 0 takes a free one, see `port`.
        seed: of the jitter.
    """

    def __init__(
        self, target_port: int, *, target_host: str = "127.0.0.1", port: int = 0, host: str = "127.0.0.1", seed: int = 0
    ) -> None:
        self._target = (target_host, target_port)
        self._listener = socket.create_server((host, port))
        self.port: int = self._listener.getsockname()[1]
        self._random = random.Random(seed)
        self._changed = threading.Condition()
        self._mean_s = self._jitter_s = 0.0
        self._stalled_until_s = 0.0
        self._is_cut = self._closed = False
        self._open: set[socket.socket] = set()
        self._bytes_to_target = self._bytes_from_target = 0

    def __enter__(self) -> Self:
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._closed = True
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)  # wakes accept, which close does not
        self._listener.close()
        self.cut()

    @property
    def carried_bytes(self) -> tuple[int, int]:
        """Bytes that have been delivered so far, those being delivered included: to the target, and from it."""
        return self._bytes_to_target, self._bytes_from_target

    @property
    def connections(self) -> int:
        """Connections that are open now."""
        return len(self._open) // 2

    def delay(self, mean_s: float, jitter_s: float = 0.0) -> None:
        """Deliver what is sent from now on later by `mean_s`, give or take up to `jitter_s`, in either direction."""
        with self._changed:
            self._mean_s, self._jitter_s = mean_s, jitter_s

    def stall(self, seconds: float) -> None:
        """Let no byte pass for a while; connections stay, and what is on its way arrives afterwards."""
        with self._changed:
            self._stalled_until_s = time.monotonic() + seconds

    def cut(self) -> None:
        """Reset all connections, what is on its way is lost, and refuse new ones until `mend`."""
        with self._changed:
            self._is_cut = True
            ending, self._open = self._open, set()
            self._changed.notify_all()
        for connection in ending:
            _reset(connection)

    def mend(self) -> None:
        """Accept connections again, and end a stall."""
        with self._changed:
            self._is_cut, self._stalled_until_s = False, 0.0
            self._changed.notify_all()

    def _accept(self) -> None:
        while not self._closed:
            try:
                incoming, _ = self._listener.accept()
            except OSError:  # closed
                return
            threading.Thread(target=self._connect, args=(incoming,), daemon=True).start()

    def _connect(self, incoming: socket.socket) -> None:
        try:
            outgoing = socket.create_connection(self._target, CONNECT_S)
        except OSError:
            _reset(incoming)
            return
        with self._changed:
            refused = self._is_cut
            if not refused:
                self._open |= {incoming, outgoing}
        for connection in (incoming, outgoing):
            connection.settimeout(None)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if refused:
                _reset(connection)
        if not refused:
            _Direction(self, incoming, outgoing, to_target=True).start()
            _Direction(self, outgoing, incoming, to_target=False).start()

    def _due_s(self) -> float:
        """Return when a byte is to be delivered that is read now, by time.monotonic()."""
        with self._changed:
            return time.monotonic() + max(self._mean_s + self._random.uniform(-1, 1) * self._jitter_s, 0.0)

    def _pass_at(self, due_s: float, connection: socket.socket) -> bool:
        """Wait for that time and for the end of a stall; False if the connection has been cut meanwhile."""
        with self._changed:
            while connection in self._open:
                left_s = max(due_s, self._stalled_until_s) - time.monotonic()
                if left_s <= 0:
                    return True
                self._changed.wait(left_s)
        return False

    def _carried(self, size: int, to_target: bool) -> None:
        with self._changed:
            self._bytes_to_target += size * to_target
            self._bytes_from_target += size * (not to_target)

    def _drop(self, *connections: socket.socket) -> None:
        with self._changed:
            self._open -= {*connections}
            self._changed.notify_all()
        for connection in connections:
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)
            connection.close()


class _Direction:
    """One direction of a connection: one thread reads, one delivers when the time has come.

    Where one end ends, both directions end.
    """

    def __init__(self, proxy: TcpProxy, source: socket.socket, sink: socket.socket, to_target: bool) -> None:
        self._proxy, self._source, self._sink, self._to_target = proxy, source, sink, to_target
        self._waiting: collections.deque[tuple[float, bytes]] = collections.deque()
        self._waiting_bytes = 0
        self._changed = threading.Condition()

    def start(self) -> None:
        for work in (self._read, self._deliver):
            threading.Thread(target=work, daemon=True).start()

    def _read(self) -> None:
        """Queue what comes; an empty chunk says that the sender has ended."""
        while self._proxy._pass_at(0.0, self._source):
            try:
                chunk = self._source.recv(READ_BYTES)
            except OSError:
                chunk = b""
            with self._changed:
                self._waiting.append((self._proxy._due_s(), chunk))
                self._waiting_bytes += len(chunk)
                self._changed.notify_all()
                if not chunk:
                    return
                self._changed.wait_for(lambda: self._waiting_bytes < IN_FLIGHT_BYTES)

    def _deliver(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting)
                due_s, chunk = self._waiting[0]
            if not self._proxy._pass_at(due_s, self._sink) or not chunk or not self._sent(chunk):
                break
            with self._changed:
                self._waiting.popleft()
                self._waiting_bytes -= len(chunk)
                self._changed.notify_all()
        self._proxy._drop(self._source, self._sink)
        with self._changed:
            self._waiting_bytes = 0
            self._changed.notify_all()

    def _sent(self, chunk: bytes) -> bool:
        self._proxy._carried(len(chunk), self._to_target)  # first, so that who has received bytes finds them counted
        try:
            self._sink.sendall(chunk)
        except OSError:
            return False
        return True


def _reset(connection: socket.socket) -> None:
    """End a connection with RST; the shutdown first wakes the threads that read it and write to it."""
    with contextlib.suppress(OSError):
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()
