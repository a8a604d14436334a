"""Which of several processes serves a sensor that they share: rendezvous hashing over liveliness tokens.

Each process that may serve the sensor holds the token `member`. The member with the largest hash of its name and the
sensor's serves it: all members agree without a word, and where one comes or goes, only its own sensors change hands.
"""

import hashlib
import math
import time
from collections.abc import Callable, Iterable, Sequence

import zenoh

from actum import keys
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.node import SECOND_NS
from actum.runtime.place import Place
from actum.settings import ServiceSettings

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

    def is_this_ones_turn(self) -> bool:
        """Tell whether no other instance runs, and the sensor is this instance's."""
        others = self._rivals()
        return others is not None and not others and self._rightful(self._others() or ()) is None

    def leave(self) -> None:
        """Withdraw the tokens of the running instance, and stay a member."""
        for key in self._tokens.keys() - {self._member_key}:
            self._undeclare(key)

    def _loses_to(self, others: Sequence[keys.Claim]) -> str | None:
        """Return the instance to make room for: also the member whose sensor this is, at the end of a segment."""
        rightful = self._rightful(others)
        if rightful is None:
            self._overdue_since_s = None
        else:
            self._overdue_since_s = self._overdue_since_s or time.monotonic()
            if not self._is_busy() or time.monotonic() - self._overdue_since_s > LONGEST_WAIT_S:
                return rightful
        return super()._loses_to(others)

    def _rightful(self, others: Sequence[keys.Claim]) -> str | None:
        """Return the other member whose sensor this is; None where it is this instance's."""
        sensor, own = self._settings.sensor, self._settings.instance
        server = server_of(sensor, [own, *(other.instance for other in others if other.role == "member")])
        return None if server == own else server
