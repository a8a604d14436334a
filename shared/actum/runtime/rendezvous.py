"""Which of several processes serves a sensor that they share: rendezvous hashing over liveliness tokens.

Each process that may serve the sensor holds the token `member`. The member with the largest hash of its name and the
sensor's serves it: all members compute the same result, and if one comes or goes, only its own sensors change hands.
"""

import hashlib
import logging
import math
import time
from collections.abc import Callable, Iterable, Sequence

import zenoh

from actum import keys
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.node import SECOND_NS
from actum.runtime.place import LOST_S, RETURNING_S, SETTLING_S, Place
from actum.runtime.session import connected
from actum.settings import ServiceSettings

log = logging.getLogger("actum")

LONGEST_WAIT_S = (MAX_SEGMENT_NS + MAX_SKEW_NS) / SECOND_NS
"""How long a process may keep a sensor that is another's (s): the longest segment is over by then."""


def server_of(sensor: str, instances: Iterable[str]) -> str | None:
    """Return which of these instances serves a sensor; None where there is none."""
    return max(instances, key=lambda instance: hashlib.blake2b(f"{sensor}/{instance}".encode()).digest(), default=None)


class SharedPlace(Place):
    """The right to run as a service of a sensor that several instances share.

    Args:
        session: the connection.
        settings: of the service.
        service: its name.
        is_busy: tells whether this instance, while it runs, is in the middle of a segment.
    """

    def __init__(
        self, session: zenoh.Session, settings: ServiceSettings, service: str, is_busy: Callable[[], bool]
    ) -> None:
        super().__init__(session, settings, service)
        member = keys.Claim("member", settings.instance, str(session.zid()))
        self._member_key = keys.claim_key(member, settings.sensor, service)
        self._is_busy = is_busy
        self._overdue_since_s: float | None = None
        self._unanswered_since_s: float | None = None
        self._lost_s = -math.inf

    def join(self) -> None:
        """Become one of those who share the sensor."""
        self._declare(self._member_key)

    def resign(self) -> None:
        """Share the sensor no longer."""
        self._undeclare(self._member_key)

    @property
    def has_been_held(self) -> bool:
        """Whether another instance has been seen to run."""
        return self._last_held_s > -math.inf

    @property
    def vacant_s(self) -> float:
        """Infinite, whoever ran before: members listen to each other's answers, so none is unknown."""
        return math.inf

    @property
    def settling_s(self) -> float:
        """How long a candidate must see no other (s): longer after the router was away, until others have returned."""
        return RETURNING_S if time.monotonic() - self._lost_s < RETURNING_S else SETTLING_S

    def is_this_ones_turn(self) -> bool:
        """Tell whether no other instance runs or is about to, and the sensor is this instance's."""
        others = self._others()
        self._note_whether_answered(others is not None)
        if others is None:
            return False
        if any(other.role == "alive" for other in others):
            self._last_held_s = time.monotonic()
        is_vacant = not any(other.role in ("alive", "candidate") for other in others)
        return is_vacant and self._rightful(others) is None

    def leave(self) -> None:
        """Withdraw the tokens of the running instance, and stay a member."""
        self._overdue_since_s = None
        for key in self._tokens.keys() - {self._member_key}:
            self._undeclare(key)

    def _note_whether_answered(self, is_answered: bool) -> None:
        """Note when the router last failed to answer; warn once where it never does, though it is connected."""
        now_s = time.monotonic()
        if is_answered or not connected(self._session):
            self._unanswered_since_s = None
        if is_answered:
            return
        self._lost_s = now_s
        if connected(self._session) and self._unanswered_since_s is None:
            self._unanswered_since_s = now_s
        elif self._unanswered_since_s is not None and now_s - self._unanswered_since_s > LOST_S:
            self._unanswered_since_s = math.inf
            log.warning(
                "sensor %s cannot be shared, because the router does not report which other processes share this "
                "sensor: allow liveliness_query in the router's access control",
                self._settings.sensor,
            )

    def _loses_to(self, others: Sequence[keys.Claim]) -> str | None:
        """Return the instance to make room for: also the member whose sensor this is, at the end of a segment.

        Where two members run, as after a link was cut, the one whose sensor this is goes on.
        """
        running = {other.instance for other in others if other.role == "alive"}
        members = {other.instance for other in others if other.role == "member"}
        rightful = self._rightful(others)
        if rightful is None:
            self._overdue_since_s = None
            return super()._loses_to([other for other in others if other.instance not in running & members])
        self._overdue_since_s = self._overdue_since_s or time.monotonic()
        is_overdue = time.monotonic() - self._overdue_since_s > LONGEST_WAIT_S
        if rightful in running or is_overdue or not self._is_busy():
            return rightful
        return super()._loses_to(others)

    def _rightful(self, others: Sequence[keys.Claim]) -> str | None:
        """Return the other member whose sensor this is; None where it is this instance's."""
        sensor, own = self._settings.sensor, self._settings.instance
        server = server_of(sensor, [own, *(other.instance for other in others if other.role == "member")])
        return None if server == own else server
