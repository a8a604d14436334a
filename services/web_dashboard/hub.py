"""What goes to the browsers: encoded once for all, and kept for each until it can take it.

A browser that takes nothing, because its tab is stalled or its network is slow, costs the others nothing: of each
stream it has one place, which the newest message fills, and a bounded queue for what must not be lost.
"""

import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

LONGEST_QUEUE = 1000
"""Messages that wait for one browser; half an hour of a busy scene. In a longer queue the oldest are left out."""
REMEMBERED = 400
"""Messages that must not be lost, kept for a page that is opened or loaded anew: its timeline's last minutes."""
MOST_BYTES = 32_000_000
"""Size (bytes, characters of text) of what waits for one browser, and of what is remembered: a hundred times a scene's.
In a longer queue, too, the oldest are left out."""
MOST_KEPT = 32
"""Most streams of which the newest message is kept for pages opened later: the services' status, and the trainer."""
MOST_STREAMS = 256
"""Most streams that have a place: agents come and go with new numbers, and the one silent for longest makes room."""


@dataclass(frozen=True)
class Envelope:
    """A message as browsers get it.

    Attributes:
        stream: its name among the streams, such as `posture/1`.
        payload: JSON text, or bytes that begin with their JSON header's length.
        queued: whether each one is sent, not only the newest of its stream.
        kept: whether a page opened later gets the newest one.
    """

    stream: str
    payload: str | bytes
    queued: bool = False
    kept: bool = False


class Queue:
    """Messages in their order, limited in number and size: the oldest are left out.

    Attributes:
        left_out: how many.
    """

    def __init__(self, longest: int) -> None:
        self.left_out = 0
        self._longest = longest
        self._envelopes: deque[Envelope] = deque()
        self._size = 0

    def __iter__(self) -> Iterator[Envelope]:
        return iter(self._envelopes)

    def __len__(self) -> int:
        return len(self._envelopes)

    def append(self, envelope: Envelope) -> None:
        """Add a message at the end."""
        self._envelopes.append(envelope)
        self._size += len(envelope.payload)
        while len(self._envelopes) > self._longest or self._size > MOST_BYTES:
            self._size -= len(self._envelopes.popleft().payload)
            self.left_out += 1

    def clear(self) -> None:
        """Forget all messages."""
        self._envelopes.clear()
        self._size = 0


class Mailbox:
    """What one browser has not been sent yet."""

    def __init__(self, wake: Callable[[], object]) -> None:
        self._wake = wake
        self._queue = Queue(LONGEST_QUEUE)
        self._newest: OrderedDict[str, Envelope] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def left_out(self) -> int:
        """How many queued messages were left out."""
        return self._queue.left_out

    def put(self, envelopes: Iterable[Envelope]) -> None:
        """Take messages; those of a stream replace what waits of it, unless they are queued."""
        with self._lock:
            was_empty = not (self._queue or self._newest)
            for envelope in envelopes:
                if envelope.queued:
                    self._queue.append(envelope)
                else:
                    self._newest[envelope.stream] = envelope
                    if len(self._newest) > MOST_STREAMS:
                        self._newest.popitem(last=False)
            filled = was_empty and bool(self._queue or self._newest)
        if filled:
            self._wake()

    def empty(self) -> list[str | bytes]:
        """Return the payloads that wait, what is queued first, and forget them."""
        with self._lock:
            waiting = [*self._queue, *self._newest.values()]
            self._queue.clear()
            self._newest.clear()
        return [envelope.payload for envelope in waiting]


class Hub:
    """Gives every message to all browsers' mailboxes; thread-safe."""

    def __init__(self) -> None:
        self._mailboxes: list[Mailbox] = []
        self._past = Queue(REMEMBERED)
        self._kept: OrderedDict[str, tuple[Envelope, float]] = OrderedDict()
        self._lock = threading.Lock()
        self._left_out = 0

    @property
    def watched(self) -> bool:
        """Whether any browser is there."""
        return bool(self._mailboxes)

    @property
    def browsers(self) -> int:
        """How many browsers are there."""
        return len(self._mailboxes)

    @property
    def left_out(self) -> int:
        """How many queued messages browsers did not get since the start, because they took none for too long."""
        with self._lock:
            return self._left_out + sum(mailbox.left_out for mailbox in self._mailboxes)

    def publish(self, envelope: Envelope) -> None:
        """Give a message to all."""
        with self._lock:
            if envelope.queued:
                self._past.append(envelope)
            elif envelope.kept:
                self._kept[envelope.stream] = envelope, time.monotonic()
                self._kept.move_to_end(envelope.stream)
                if len(self._kept) > MOST_KEPT:
                    self._kept.popitem(last=False)
            for mailbox in self._mailboxes:
                mailbox.put((envelope,))

    def silent_s(self) -> dict[str, float]:
        """Return for how long nothing has come (s) of each stream of which the newest is kept."""
        now_s = time.monotonic()
        with self._lock:
            return {stream: round(now_s - came_s, 1) for stream, (_, came_s) in self._kept.items()}

    def join(self, mailbox: Mailbox) -> None:
        """Add a browser, which gets at once what is remembered."""
        with self._lock:
            self._mailboxes.append(mailbox)
            mailbox.put([*self._past, *(envelope for envelope, _ in self._kept.values())])

    def leave(self, mailbox: Mailbox) -> None:
        """Take a browser out."""
        with self._lock:
            self._mailboxes.remove(mailbox)
            self._left_out += mailbox.left_out
