"""Records a sensor's live streams to a file, and plays recordings on its keys."""

import threading
import time
from collections.abc import Sequence
from typing import Protocol

from actum import steady_clock
from actum.codec import DecodeError
from actum.messages import Message, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.runtime import Client, Listening, Pace
from actum_command.playing import schedule

LEAD_IN_S = 0.3  # longer than a service takes to reset at a new session
POLL_S = 0.005  # a sixth of a frame's interval
ON_ITS_WAY_S = 0.3  # longest delay of a message that was put before the recording was stopped


class Storing(Protocol):
    """What stores messages: `actum_examples.stream_recorder`, or what stands before it."""

    def take(self, message: Message, received_ns: int) -> None:
        """Take one message and the time it was received at (ns)."""

    def reject(self, error: DecodeError) -> None:
        """Take note of a payload that does not decode."""

    def close(self) -> None:
        """Store what is still held back."""


def store_all(listening: Listening, recorder: Storing, stop: threading.Event, deadline_s: float) -> None:
    """Store messages until stopped or until the deadline (monotonic clock), then those that were put before."""
    while not stop.is_set() and time.monotonic() < deadline_s:
        if not _store(listening, recorder):
            stop.wait(POLL_S)
    time.sleep(ON_ITS_WAY_S)
    while _store(listening, recorder):
        pass
    recorder.close()


def _store(listening: Listening, recorder: Storing) -> bool:
    """Store one message if one has come; tell whether one had."""
    received = listening.take()
    if received is None:
        return False
    if received.message is not None:
        recorder.take(received.message, steady_clock.now_ns())
    elif received.error is not None:
        recorder.reject(received.error)
    return True


def put_all(client: Client, recordings: Sequence[Recording], speed: float, stop: threading.Event) -> int:
    """Put recordings at a multiple of their pace, and return how many messages were put.

    An empty frame of the new session goes before them, so that all services reset before the first mark.

    Raises:
        RecordingError: a recording is damaged.
    """
    session_id, start_ns = f"play-{client.run}", steady_clock.now_ns()
    client.put(Skeleton(stamp_ns=start_ns - SECOND_NS, sensor=client.sensor, agents=[], session_id=session_id))
    stop.wait(LEAD_IN_S)
    pace, count = Pace(speed), 0
    for message in schedule(recordings, session_id, start_ns, client.sensor):
        if not pace.wait(message.stamp_ns, stop):
            break
        client.put(message)
        count += 1
    return count
