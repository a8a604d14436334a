"""Ensures one instance of a service for each sensor: a second one is refused, or takes over from the first.

The instance that runs holds the liveliness token `alive`. One that is about to start declares the token `candidate`
and queries the tokens of others: a router handles a session's token before its next query, so of two candidates at
least one sees the other.
"""

import logging
import math
import threading
import time
from collections.abc import Sequence
from dataclasses import replace

import zenoh

from actum import keys
from actum.messages import Info
from actum.runtime.inbox import received
from actum.runtime.session import LEASE_S, connected
from actum.settings import ServiceSettings

log = logging.getLogger("actum")

SETTLING_S = 0.25
"""How long (s) a candidate must see no other: the time that a token may take from one router to the next."""
RETURNING_S = 1.5
"""The same (s) where the router has just started: by then its earlier sessions are connected again."""
LEAVING_S = 1.5
"""How long (s) an instance that was just asked to stop may take."""
YIELDING_S = 10.0
"""How long (s) an instance may take to make room for a successor, which it looks for once a second."""
LOST_S = LEASE_S + 3.0
"""How long (s) until the token of an instance has expired whose machine died."""
POLL_S = 0.05
"""Interval between two queries of the tokens (s)."""
ANSWER_S = 0.5
"""Timeout of a query (s), from one machine to another."""


class PlaceTakenError(RuntimeError):
    """Another instance of this service runs for the sensor."""


class Alone:
    """Decides whether a candidate has seen no other instance for long enough: a pure step over results of queries."""

    def __init__(self, settling_s: float) -> None:
        self._settling_s = settling_s
        self._alone_since_s: float | None = None
        self._unanswered_since_s: float | None = None

    def for_long(self, others: Sequence[keys.Claim] | None, connected: bool, now_s: float) -> bool:
        """Take the claims of others from one query, None where it failed; tell whether the candidate may start.

        It may, too, where a connected router has left every query unanswered for `LOST_S`.
        """
        if others is None:
            self._alone_since_s, self._settling_s = None, RETURNING_S
            return connected and self._is_denied(now_s)
        self._unanswered_since_s = None
        self._alone_since_s = None if others else self._alone_since_s or now_s
        return self._alone_since_s is not None and now_s - self._alone_since_s >= self._settling_s

    def _is_denied(self, now_s: float) -> bool:
        """Tell whether the router has failed to answer for so long that its access control must forbid the query."""
        self._unanswered_since_s = self._unanswered_since_s or now_s
        if now_s - self._unanswered_since_s < LOST_S:
            return False
        log.warning(
            "this service cannot check whether another instance of the same service already runs: allow "
            "liveliness_query in the router's access control"
        )
        return True


class Place:
    """The right to run as a service of a sensor, which one instance holds at a time."""

    def __init__(self, session: zenoh.Session, settings: ServiceSettings, service: str) -> None:
        self._session, self._settings, self._service = session, settings, service
        self._candidate = keys.Claim("candidate", settings.instance, str(session.zid()))
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self._last_held_s = -math.inf

    def claim(self, stop: threading.Event, settling_s: float) -> bool:
        """Become the running instance as soon as there is no other; False if stopped before.

        Raises:
            PlaceTakenError: another instance runs, answers, and stays.
        """
        successor = keys.claim_key(replace(self._candidate, role="successor"), self._settings.sensor, self._service)
        if self._settings.take_over:
            self._declare(successor)
        taken = False
        while not taken and self._is_free(stop):
            taken = self._is_won(stop, settling_s)
        self._undeclare(successor)
        return taken

    @property
    def vacant_s(self) -> float:
        """How long ago (s) another instance was last seen to run; infinite if none ever was."""
        return time.monotonic() - self._last_held_s

    def leave(self) -> None:
        """Withdraw all tokens, so that another instance may start."""
        for key in list(self._tokens):
            self._undeclare(key)

    def lost_to(self) -> str | None:
        """Return the instance that this one is to make room for, None where it may go on."""
        others = self._others()
        return None if others is None else self._loses_to(others)

    def _loses_to(self, others: Sequence[keys.Claim]) -> str | None:
        """Return a successor, or of two instances that run the first by name."""
        for other in others:
            if other.role == "successor" or (other.role == "alive" and other.instance < self._settings.instance):
                return other.instance
        return None

    def _is_free(self, stop: threading.Event) -> bool:
        """Wait until no other instance runs or is a candidate; False if stopped before.

        Raises:
            PlaceTakenError: another instance runs, answers, and stays.
        """
        began_s = time.monotonic()
        silent: set[str] = set()
        while not stop.is_set():
            others = self._rivals()
            if not others:
                return True  # also where the query failed: a candidate repeats it until there is an answer
            for other in others:
                if other.role == "alive" and not self._may_leave(other, time.monotonic() - began_s, silent):
                    raise PlaceTakenError(self._refusal(other))
            stop.wait(POLL_S)
        return False

    def _may_leave(self, holder: keys.Claim, waited_s: float, silent: set[str]) -> bool:
        """Tell whether the running instance may yet leave: it had little time, or is silent and its token may expire.

        Args:
            holder: its claim.
            waited_s: how long this one has waited for it.
            silent: names of instances that do not answer, which are logged once; one is added where it does not.
        """
        if waited_s < (YIELDING_S if self._settings.take_over else LEAVING_S):
            return True
        if waited_s > LOST_S or self._info_of(holder) is not None:
            return False
        if holder.instance not in silent:
            log.warning(
                "another instance of this service, %s, is registered but does not answer: this instance waits until "
                "the router removes the registration",
                holder.instance,
            )
            silent.add(holder.instance)
        return True

    def _is_won(self, stop: threading.Event, settling_s: float) -> bool:
        """Declare this instance a candidate; of several the first by name wins, unless another instance runs."""
        candidate = keys.claim_key(self._candidate, self._settings.sensor, self._service)
        self._declare(candidate)
        alone = Alone(settling_s)
        won = beaten = False
        while not (won or beaten or stop.wait(POLL_S)):
            others = self._rivals()
            beaten = any(other.role == "alive" or _name(other) < _name(self._candidate) for other in others or ())
            won = alone.for_long(others, connected(self._session), time.monotonic())
        if won:
            self._declare(keys.alive(self._settings.sensor, self._service, self._settings.instance))
        self._undeclare(candidate)
        return won

    def _rivals(self) -> list[keys.Claim] | None:
        """Return the claims of running instances and candidates; None where the query failed."""
        others = self._others()
        rivals = None if others is None else [each for each in others if each.role in ("alive", "candidate")]
        if any(rival.role == "alive" for rival in rivals or ()):
            self._last_held_s = time.monotonic()
        return rivals

    def _others(self) -> list[keys.Claim] | None:
        """Return the claims of all other instances; None where the query failed."""
        expression = keys.claims(self._settings.sensor, self._service)
        replies = list(self._session.liveliness().get(expression, timeout=ANSWER_S))
        if any(reply.ok is None for reply in replies) or not connected(self._session):
            return None
        token_keys = {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}
        claims = [keys.claim_of(key) for key in sorted(token_keys - self._tokens.keys())]
        return [claim for claim in claims if claim is not None]

    def _info_of(self, holder: keys.Claim) -> Info | None:
        key = keys.key(keys.INFO, self._settings.sensor, self._service)
        replies = self._session.get(key, timeout=ANSWER_S, consolidation=zenoh.ConsolidationMode.NONE)
        for reply in replies:
            info = received(reply.ok).message if reply.ok else None
            if isinstance(info, Info) and info.instance == holder.instance:
                return info
        return None

    def _refusal(self, holder: keys.Claim) -> str:
        info = self._info_of(holder)
        host = f" on {info.host}" if info and info.host else ""
        sensor = self._settings.sensor
        if self._settings.take_over:
            return (
                f"another {self._service} still runs for sensor {sensor} ({holder.instance}{host}) and did not stop on "
                f"request: stop {holder.instance} yourself"
            )
        return (
            f"another {self._service} already runs for sensor {sensor} ({holder.instance}{host}), and two instances "
            f"would publish every result twice. Therefore this instance ({self._settings.instance}) ends. Stop the "
            "other instance, replace it by starting this instance with --take-over (ACTUM_TAKE_OVER=1), or name "
            "another sensor with --sensor"
        )

    def _declare(self, key: str) -> None:
        self._tokens[key] = self._session.liveliness().declare_token(key)

    def _undeclare(self, key: str) -> None:
        if key in self._tokens:
            self._tokens.pop(key).undeclare()


def _name(claim: keys.Claim) -> tuple[str, str]:
    return claim.instance, claim.session
