"""One service of a kind for each sensor: the second is refused, or the first makes room for it.

Who is the service holds the liveliness token `alive`. Who is to be it holds `candidate` first and looks who else is
there: a router takes a session's token before its next question, so of two candidates at least one sees the other.
"""

import logging
import math
import threading
import time
from collections.abc import Sequence
from dataclasses import replace

import zenoh

from actum import keys
from actum.codec import DecodeError, decode
from actum.messages import Info
from actum.runtime.session import LEASE_S, connected
from actum.settings import ServiceSettings

log = logging.getLogger("actum")

SETTLING_S = 0.25
"""How long a candidate looks for others: the time that a token may take from one router to the next."""
RETURNING_S = 1.5
"""The same where the router has just come: by then the sessions that it had before are back."""
LEAVING_S = 1.5
"""How long one that was just asked to stop may take."""
YIELDING_S = 10.0
"""How long one may take that is to make room: it looks for successors once a second."""
LOST_S = LEASE_S + 3.0
"""By then the token of one that was killed with its machine is gone."""
POLL_S = 0.05
"""Between two looks (s) at who else is there."""
ANSWER_S = 0.5
"""How long (s) an answer may take, of one machine to another."""


class PlaceTakenError(RuntimeError):
    """Another process is the service that this one was to be."""


class Alone:
    """Whether a candidate has been the only one for long enough: a pure step over looks at who else is there."""

    def __init__(self, settling_s: float) -> None:
        self._settling_s = settling_s
        self._alone_s: float | None = None
        self._blind_s: float | None = None

    def for_long(self, others: Sequence[keys.Claim] | None, connected: bool, now_s: float) -> bool:
        """Take what one look has shown, None where nobody answered."""
        if others is None:
            self._alone_s, self._settling_s = None, RETURNING_S
            return connected and self._is_denied(now_s)
        self._blind_s = None
        self._alone_s = None if others else self._alone_s or now_s
        return self._alone_s is not None and now_s - self._alone_s >= self._settling_s

    def _is_denied(self, now_s: float) -> bool:
        """Whether a router that is there never answers, and so is not to."""
        self._blind_s = self._blind_s or now_s
        if now_s - self._blind_s < LOST_S:
            return False
        log.warning("nobody tells whether this runs twice: allow liveliness_query in the router's access control")
        return True


class Place:
    """The place of one service at one sensor, which one process has at a time."""

    def __init__(self, session: zenoh.Session, settings: ServiceSettings, service: str) -> None:
        self._session, self._settings, self._service = session, settings, service
        self._candidate = keys.Claim("candidate", settings.instance, str(session.zid()))
        self._own: dict[str, zenoh.LivelinessToken] = {}
        self._held_s = -math.inf

    def take(self, stop: threading.Event, settling_s: float) -> bool:
        """Take the place as soon as nobody has it; False if stopped before.

        Raises:
            PlaceTakenError: somebody has it, answers, and stays.
        """
        successor = keys.wish(replace(self._candidate, role="successor"), self._settings.sensor, self._service)
        if self._settings.take_over:
            self._declare(successor)
        taken = False
        while not taken and self._is_free(stop):
            taken = self._is_won(stop, settling_s)
        self._undeclare(successor)
        return taken

    @property
    def vacant_s(self) -> float:
        """For how long nobody else has been seen to have it; infinite if nobody ever was."""
        return time.monotonic() - self._held_s

    def leave(self) -> None:
        """Let others have it."""
        for key in list(self._own):
            self._undeclare(key)

    def lost_to(self) -> str | None:
        """Tell who is to have the place instead: a successor, or the first by name of two that have it."""
        for other in self._others() or ():
            if other.role == "successor" or (other.role == "alive" and other.instance < self._settings.instance):
                return other.instance
        return None

    def _is_free(self, stop: threading.Event) -> bool:
        """Wait until nobody has or is about to take the place; False if stopped before."""
        met_s = time.monotonic()
        silent: set[str] = set()
        while not stop.is_set():
            others = self._rivals()
            if not others:
                return True  # also where nobody can tell: a candidate waits until somebody does
            for other in others:
                if other.role == "alive" and not self._may_leave(other, time.monotonic() - met_s, silent):
                    raise PlaceTakenError(self._refusal(other))
            stop.wait(POLL_S)
        return False

    def _may_leave(self, holder: keys.Claim, waited_s: float, silent: set[str]) -> bool:
        """Whether who has the place may yet be gone: it has had no time, or does not answer and its token may lapse."""
        if waited_s < (YIELDING_S if self._settings.take_over else LEAVING_S):
            return True
        if waited_s > LOST_S or self._info_of(holder) is not None:
            return False
        if holder.instance not in silent:
            log.warning("%s does not answer: waiting until it is given up", holder.instance)
            silent.add(holder.instance)
        return True

    def _is_won(self, stop: threading.Event, settling_s: float) -> bool:
        """Stand as a candidate; the first by name wins, unless somebody has the place already."""
        candidate = keys.wish(self._candidate, self._settings.sensor, self._service)
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
        """List who else has or is about to take the place, a successor comes later; None where nobody can tell."""
        others = self._others()
        rivals = None if others is None else [other for other in others if other.role != "successor"]
        if any(rival.role == "alive" for rival in rivals or ()):
            self._held_s = time.monotonic()
        return rivals

    def _others(self) -> list[keys.Claim] | None:
        expression = keys.claims(self._settings.sensor, self._service)
        replies = list(self._session.liveliness().get(expression, timeout=ANSWER_S))
        if any(reply.ok is None for reply in replies) or not connected(self._session):
            return None
        found = {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}
        claims = [keys.claim_of(key) for key in sorted(found - self._own.keys())]
        return [claim for claim in claims if claim is not None]

    def _info_of(self, holder: keys.Claim) -> Info | None:
        key = keys.key(keys.INFO, self._settings.sensor, self._service)
        replies = self._session.get(key, timeout=ANSWER_S, consolidation=zenoh.ConsolidationMode.NONE)
        for reply in replies:
            try:
                info = decode(key, reply.ok.payload.to_bytes(), str(reply.ok.encoding)) if reply.ok else None
            except DecodeError:
                continue
            if isinstance(info, Info) and info.instance == holder.instance:
                return info
        return None

    def _refusal(self, holder: keys.Claim) -> str:
        info = self._info_of(holder)
        host = f" on {info.host}" if info and info.host else ""
        other = f"another {self._service} runs for sensor {self._settings.sensor}: {holder.instance}{host}"
        if self._settings.take_over:
            return f"{other}, and does not make room: stop it there"
        return (
            f"{other}. Two would answer everything twice, so this one, {self._settings.instance}, ends: stop the "
            "other, go on in its place with --take-over (ACTUM_TAKE_OVER=1), or name another viewpoint by --sensor"
        )

    def _declare(self, key: str) -> None:
        self._own[key] = self._session.liveliness().declare_token(key)

    def _undeclare(self, key: str) -> None:
        if key in self._own:
            self._own.pop(key).undeclare()


def _name(claim: keys.Claim) -> tuple[str, str]:
    return claim.instance, claim.session
