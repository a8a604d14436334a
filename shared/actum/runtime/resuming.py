"""Lets a node go on where the process before it ended: tells it what was answered, and writes down its answers."""

import logging
import math
import threading
import time
from collections import OrderedDict
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER
from actum.codec import DecodeError, Frame, decode
from actum.messages import Action, Event, Message
from actum.node import Counters, Remembering
from actum.runtime.inbox import HISTORY_S, RESUMED_FRAMES_S, RESUMED_S, Reach
from actum.runtime.journal import Journal, WrittenAnswer
from actum.runtime.outbox import Outbox
from actum.settings import RememberingSettings, ServiceSettings, SettingsError

log = logging.getLogger("actum")

Segment = tuple[str, str, int | None, int | None] | None
"""What tells a segment from others: session, id, start and end; None for what is no answer."""
KEPT_S = 2 * RESUMED_S
"""How old an answer is forgotten (s): marks as old are not requested."""
MOST_HEARD = 1024
"""Most answers kept for one sensor: more than are given in that time."""


def check_state_folder(settings: ServiceSettings) -> None:
    """Make the folder of `state`, where one is set.

    Raises:
        SettingsError: it cannot be made.
    """
    folder = _state_folder(settings)
    try:
        if folder is not None:
            folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
    except OSError as error:
        raise SettingsError(
            f"state: the folder {folder} cannot be created ({error.strerror}): set ACTUM_STATE to another folder"
        ) from None


def _state_folder(settings: ServiceSettings) -> Path | None:
    return settings.state if isinstance(settings, RememberingSettings) else None


class HeardAnswers:
    """The answers that processes which share a sensor have put lately, in memory; thread-safe.

    It stands in place of a journal, so its names are those of `Journal`.

    Attributes:
        is_new: whether no other process was ever there.
        unread: None, since there is no file.
    """

    unread = None

    def __init__(self) -> None:
        self._began_s = time.monotonic()
        self._answers: OrderedDict[bytes, WrittenAnswer] = OrderedDict()
        self._elsewhere: OrderedDict[Segment, bytes] = OrderedDict()
        self._lock = threading.Lock()
        self.is_new = True

    @property
    def answers(self) -> list[WrittenAnswer]:
        """The answers, the oldest first."""
        with self._lock:
            return [answer for answer in self._answers.values() if answer.age_s <= KEPT_S]

    @property
    def age_s(self) -> float:
        """How long it has been listening (s)."""
        return time.monotonic() - self._began_s

    def add(self, frame: Frame) -> None:
        """Keep an answer that is about to be put."""
        with self._lock:
            self._keep(WrittenAnswer(time.time_ns(), frame))

    def hear(self, answer: WrittenAnswer, message: Message) -> None:
        """Keep an answer that was heard, unless this process has put it itself."""
        with self._lock:
            if answer.frame.payload not in self._answers:
                self._keep(answer)
                self._elsewhere[_segment_of(message)] = answer.frame.payload

    def is_answered_elsewhere(self, message: Message) -> bool:
        """Tell whether another process has answered the segment of an answer."""
        with self._lock:
            return _segment_of(message) in self._elsewhere

    def store(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing: it goes on while another process serves the sensor."""

    def _keep(self, answer: WrittenAnswer) -> None:
        """Keep an answer, and forget what is too old or too much."""
        self._answers[answer.frame.payload] = answer
        while len(self._answers) > MOST_HEARD or next(iter(self._answers.values())).age_s > KEPT_S:
            self._answers.popitem(last=False)
            while self._elsewhere and next(iter(self._elsewhere.values())) not in self._answers:
                self._elsewhere.popitem(last=False)
            if not self._answers:
                return


def _segment_of(answer: Message) -> Segment:
    """Return what tells the segment of a final action or an event from all others; None for any other message."""
    match answer:
        case Action(final=True) | Event():
            return answer.session_id, answer.segment_id, answer.start_ns, answer.end_ns
        case _:
            return None


class Resumption:
    """The journal of a node that remembers its answers."""

    def __init__(self, node: Remembering, journal: Journal | HeardAnswers, counters: Counters) -> None:
        self._node, self._journal, self._counters = node, journal, counters
        self._writes = True

    @classmethod
    def of(cls, node: object, name: str, settings: ServiceSettings, counters: Counters) -> "Resumption | None":
        """Open the journal in the folder that is set; None where there is none, or the node needs none."""
        folder = _state_folder(settings)
        if folder is None or not isinstance(node, Remembering):
            return None
        journal = Journal(folder / f"{settings.sensor}-{name}.journal")
        resumption = cls(node, journal, counters)
        if journal.unread is not None:
            resumption.report(journal.unread)
        return resumption

    def resume(self, outbox: Outbox, vacant_s: float) -> Reach:
        """Tell the node what was answered and offer it to late subscribers; write down what is put from now on.

        Returns how far back messages are to be requested: where another instance has just run, its answers may stand
        in no journal of ours.
        """
        outbox.keep_by(self._keep)
        recent_s = min(vacant_s, HISTORY_S)
        if self._journal.is_new:
            return Reach(recent_s, RESUMED_S, depth=None)
        known = [(answer, message) for answer in self._journal.answers if (message := _decoded(answer))]
        self._node.remember([message for _, message in known])
        outbox.recall(known)
        if vacant_s < math.inf:
            return Reach(recent_s, RESUMED_S, depth=None)
        return Reach(min(self._journal.age_s + HISTORY_S, RESUMED_S), RESUMED_S, RESUMED_FRAMES_S, depth=None)

    def admits(self, output: Message) -> bool:
        """Tell whether an output may be put: not an answer to what another process has answered; that is counted."""
        journal = self._journal
        if not isinstance(journal, HeardAnswers) or not journal.is_answered_elsewhere(output):
            return True
        self._counters.counts["answered_elsewhere"] += 1
        return False

    def store(self) -> None:
        """Have stored on the disk what was written.

        Raises:
            OSError: that failed.
        """
        self._journal.store()

    def close(self) -> None:
        """Close the journal; where its end cannot be stored, that is counted."""
        try:
            self._journal.close()
        except OSError as error:
            self.report(error)

    def report(self, error: OSError) -> None:
        """Count that answers cannot be written, and log it where they could be before."""
        reason = f"{error.filename or 'the journal'}: {error.strerror}"
        self._counters.reject("unwritable_state", reason)
        if self._writes:
            log.warning(
                "the service cannot use the file in which it stores what it has published (%s): check that the file is "
                "readable and writable, and that the disk is not full. Without this file, the service can publish "
                "different results for the same segments after a restart",
                reason,
            )
        self._writes = False

    def _keep(self, frame: Frame) -> None:
        """Write down an answer; where that fails it is put all the same, and the failure is counted."""
        try:
            self._journal.add(frame)
            self._writes = True
        except OSError as error:
            self.report(error)


def _decoded(answer: WrittenAnswer) -> Message | None:
    """Decode an answer; None for one of another version of actum."""
    try:
        return decode(answer.frame.key, answer.frame.payload, answer.frame.encoding)
    except DecodeError:
        return None
