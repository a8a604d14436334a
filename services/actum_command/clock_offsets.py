"""How far the clocks of hosts are apart: estimated as NTP does, from questions to services and stamped answers."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from actum.node import SECOND_NS
from actum.runtime import Answer

ROUNDS = 5
"""Questions to each service: the one that was answered fastest counts."""
TOLD_S = 0.1
"""Least offset (s) that is told: NTP keeps clocks nearer to each other."""


@dataclass(frozen=True)
class ClockOffset:
    """How far another host's wall clock is ahead of this one's (s), give or take `uncertainty_s`."""

    ahead_s: float
    uncertainty_s: float


def offset(answer: Answer) -> ClockOffset:
    """Estimate an offset from one answer: it was stamped at some time between question and answer."""
    half_way_ns = (answer.answered_ns - answer.asked_ns) / 2
    ahead_ns = (answer.info.stamp_ns or 0) - (answer.came_ns - half_way_ns)
    return ClockOffset(ahead_ns / SECOND_NS, half_way_ns / SECOND_NS)


def offsets(answers: Iterable[Answer]) -> dict[str, ClockOffset]:
    """Return the best estimate for each host that says its name: the least uncertain."""
    found: defaultdict[str, list[ClockOffset]] = defaultdict(list)
    for answer in answers:
        found[answer.info.host or answer.info.instance].append(offset(answer))
    return {host: min(estimates, key=lambda each: each.uncertainty_s) for host, estimates in found.items()}


def remarks(found: dict[str, ClockOffset]) -> Iterator[str]:
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
