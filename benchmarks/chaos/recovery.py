"""How long after a fault everything works again: a pure measure over what was heard."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from actum.messages import Message, Objects, Posture, Skeleton, Status

from .faults import SERVICES, Fault

CURRENT_S = 0.5
"""A stream works as it should where it says what was less than this ago (s): the pipeline takes tens of ms."""

NEVER_S = float("-inf")
"""When something was captured of which nobody knows when."""
SHOWN_BY_STATUS = {
    "pose_preprocessor": ("skeleton",),
    "som_classifier": ("posture",),
    "action_fusion": ("posture", "objects"),
}
"""Services that show by their status that they work, each with the streams that they need; the preprocessor while
nobody is in view."""


@dataclass
class Strike:
    """A fault that came about: when it began and was over (s, monotonic), and when all worked again, None if never."""

    fault: Fault
    began_s: float
    over_s: float
    well_s: float | None = None

    @property
    def recovery_s(self) -> float | None:
        """From the fault's end until all worked again (s)."""
        return None if self.well_s is None else self.well_s - self.over_s


@dataclass(frozen=True)
class Sign:
    """A message by which a service shows that it works: when it came, and of when it speaks (s, monotonic)."""

    arrived_s: float
    of_s: float


@dataclass
class Signs:
    """The signs of all services; stamps of the scene are told apart by its sessions, each with its own origin."""

    by_service: dict[str, list[Sign]] = field(default_factory=lambda: {service: [] for service in SERVICES})
    _origins_s: dict[str, float] = field(default_factory=dict)
    _session_id: str = ""
    _somebody: bool = False

    def hear(self, message: Message, now_s: float, clock_ns: int) -> None:
        """Take a message that came at `now_s`; `clock_ns` is the machine's clock then."""
        match message:
            case Skeleton():
                self._session_id, self._somebody = message.session_id, bool(message.agents)
                origin_s = now_s - message.stamp_ns / 1e9
                self._origins_s[self._session_id] = min(origin_s, self._origins_s.get(self._session_id, origin_s))
                self._sign("sensor_gateway", now_s, self._captured_s(message))
            case Posture():
                self._sign("pose_preprocessor", now_s, self._captured_s(message))
            case Objects():
                self._sign("marker_tracker", now_s, self._captured_s(message))
            case Status(service=service) if service in SHOWN_BY_STATUS and self._is_fed(message):
                self._sign(service, now_s, now_s - (clock_ns - message.stamp_ns) / 1e9)

    def well_s(self, strike: Strike) -> float | None:
        """Return when all that the fault concerned had shown to work again, None if it never had."""
        shown = [self._shown_s(service, strike.over_s) for service in concerned(strike.fault)]
        return None if None in shown else max(each for each in shown if each is not None)

    def _shown_s(self, service: str, over_s: float) -> float | None:
        current = (
            sign.arrived_s
            for sign in self.by_service[service]
            if sign.of_s >= over_s and sign.arrived_s - sign.of_s <= CURRENT_S
        )
        return next(current, None)

    def _sign(self, service: str, arrived_s: float, of_s: float) -> None:
        self.by_service[service].append(Sign(arrived_s, of_s))

    def _captured_s(self, message: Message) -> float:
        """Return when what a message tells was captured (s, monotonic), by the session that runs."""
        return self._origins_s.get(self._session_id, NEVER_S) + message.stamp_ns / 1e9

    def _is_fed(self, status: Status) -> bool:
        """Tell whether a service gets its streams; there is no posture while nobody is in view."""
        streams = {key.split("/")[2] for key, rate in status.rates.items() if rate > 0}
        wanted = {stream for stream in SHOWN_BY_STATUS[status.service] if stream != "posture" or self._somebody}
        needs_nobody = status.service == "pose_preprocessor" and self._somebody  # its postures show that it works
        return streams >= wanted and not needs_nobody


def concerned(fault: Fault) -> Sequence[str]:
    """List the services that a fault concerns: its victim and those behind it in the stream."""
    behind = {
        "pose_preprocessor": ("pose_preprocessor", "som_classifier", "action_fusion"),
        "marker_tracker": ("marker_tracker", "action_fusion"),
        "som_classifier": ("som_classifier",),
        "action_fusion": ("action_fusion",),
    }
    return behind.get(fault.victim, SERVICES)


def measure(strikes: Iterable[Strike], signs: Signs) -> None:
    """Note for each fault when all worked again."""
    for strike in strikes:
        strike.well_s = signs.well_s(strike)
