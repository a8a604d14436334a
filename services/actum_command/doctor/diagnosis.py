"""What is wrong with a running system: services, streams, access control, clocks; each finding says what to do."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from actum.node import SECOND_NS
from actum.runtime import Answer, Client
from actum_command.doctor import stream_checks
from actum_command.doctor.heard import Heard, hear
from actum_command.doctor.service_checks import Finding, finding
from actum_command.processes import SERVICES

GATEWAY, BRIDGE = "sensor_gateway", "ros2_bridge"
"""The services that publish skeletons: the simulated scene has the gateway's name, the bridge reads bodies."""
EXPECTED = (GATEWAY, *SERVICES)
"""The services of a whole system whose skeletons do not come from ROS 2."""

ROLE = "set ACTUM_CREDENTIALS to the credentials folder of a role that is allowed to read messages, such as viewer"
"""What to do where access control keeps a program from reading."""

TOLD_S = 0.1
"""Least offset (s) that is told: NTP keeps clocks nearer to each other."""


@dataclass(frozen=True)
class Examination:
    """What was found: each service by itself, problems of the whole, what is no problem, and plain facts."""

    findings: list[Finding]
    problems: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    facts: tuple[str, ...] = ()


def examine(client: Client) -> Examination:
    """Check every service that is expected or alive, the streams between them, and the hosts' clocks."""
    heard = hear(client)
    hidden = everything_denied(heard, client)
    if hidden is not None:
        return Examination([], (hidden,))
    there = {*heard.tokens, *heard.statuses}
    reads_bodies = any(info.service == BRIDGE and info.source for info in heard.infos)
    expected = [name for name in EXPECTED if not (reads_bodies and name == GATEWAY)]
    names = [*expected, *sorted(there - set(expected))]
    two = two_sources() if reads_bodies and GATEWAY in there else ()
    problems = (*partly_denied(heard), *two, *stream_checks.problems(heard.infos, heard.statuses, heard.streams))
    clocks = clock_remarks(clock_offsets(heard.answers))
    facts = (*stream_checks.hops(heard), *who_serves(heard))
    return Examination([finding(name, heard) for name in names], problems, tuple(clocks), facts)


def two_sources() -> Iterator[str]:
    """Yield the problem of a sensor whose skeletons two programs publish."""
    yield (
        f"both {GATEWAY} and {BRIDGE} publish this sensor's skeletons, so people are mixed up: stop {GATEWAY}, or "
        f"start {BRIDGE} without --ros-bodies or with another --sensor"
    )


def who_serves(heard: Heard) -> Iterator[str]:
    """Yield a line for each service whose sensor several processes share."""
    for service, members in sorted(heard.members.items()):
        serving = heard.tokens.get(service, [])
        others = sorted(set(members) - set(serving))
        standing_by = f"; standing by: {', '.join(others)}" if others else ""
        yield (
            f"several processes run {service} for this sensor, as intended: {', '.join(serving) or 'none of them yet'} "
            f"serves the sensor{standing_by}"
        )


def everything_denied(heard: Heard, client: Client) -> str | None:
    """Return what access control hides where nothing at all was heard; None where nothing is hidden, or cannot be."""
    if heard.tokens or heard.answers or heard.statuses:
        return None
    if any(client.offers(service) for service in EXPECTED):
        return (
            "services run, but the router's access control denies this program permission to read what they publish: "
            f"{ROLE}"
        )
    if client.router_tells():
        return None
    return (
        "the router lets this program connect but answers none of its queries: either no service runs, or the router's "
        f"access control denies this program permission to read anything. If services should be running, {ROLE}"
    )


def partly_denied(heard: Heard) -> Iterator[str]:
    """Yield what is missing of services that are known otherwise."""
    answering = {answer.info.service for answer in heard.answers}
    running = heard.tokens.keys() | heard.statuses.keys() | answering
    for what, known in (("their liveliness tokens", heard.tokens.keys()), ("their info keys", answering)):
        if running and not known:
            yield f"services run, but the router's access control denies this program permission to read {what}: {ROLE}"
    if heard.tokens and not heard.statuses:
        yield (
            "services run, but none of their status messages arrives. If all services hang, restart the services. If "
            f"the router's access control denies this program permission to read status messages, {ROLE}"
        )


@dataclass(frozen=True)
class ClockOffset:
    """How far another host's wall clock is ahead of this one's (s), give or take `uncertainty_s`."""

    ahead_s: float
    uncertainty_s: float


def clock_offset(answer: Answer) -> ClockOffset:
    """Estimate an offset from one answer: it was stamped at some time between question and answer."""
    half_way_ns = (answer.answered_ns - answer.asked_ns) / 2
    ahead_ns = (answer.info.stamp_ns or 0) - (answer.came_ns - half_way_ns)
    return ClockOffset(ahead_ns / SECOND_NS, half_way_ns / SECOND_NS)


def clock_offsets(answers: Iterable[Answer]) -> dict[str, ClockOffset]:
    """Return the best estimate for each host that says its name: the least uncertain."""
    found: defaultdict[str, list[ClockOffset]] = defaultdict(list)
    for answer in answers:
        found[answer.info.host or answer.info.instance].append(clock_offset(answer))
    return {host: min(estimates, key=lambda each: each.uncertainty_s) for host, estimates in found.items()}


def clock_remarks(found: dict[str, ClockOffset]) -> Iterator[str]:
    """Yield a line for each clock that is apart; hosts, or containers of one, whose clocks agree share a line."""
    sharing: defaultdict[float, list[str]] = defaultdict(list)
    for host, each in found.items():
        if abs(each.ahead_s) > TOLD_S + each.uncertainty_s:
            sharing[round(each.ahead_s / TOLD_S)].append(host)
    for hosts in sharing.values():
        each = found[hosts[0]]
        yield (
            f"the clock of {', '.join(sorted(hosts))} is {abs(each.ahead_s):.2f} s (± {each.uncertainty_s:.3f} s) "
            f"{'ahead of' if each.ahead_s > 0 else 'behind'} the clock of this host. Recognition is not affected; to "
            "get equal times in the logs, run NTP on all these hosts"
        )
