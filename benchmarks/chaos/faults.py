"""The faults of a run, drawn by a seed: who is struck, how, and when."""

import random
from dataclasses import dataclass
from itertools import product
from typing import Literal

Kind = Literal["killed", "paused", "cut", "silent"]
KINDS: tuple[Kind, ...] = ("killed", "paused", "cut", "silent")
"""SIGKILL; SIGSTOP; all connections end and no new ones are accepted; no byte passes, and connections stay."""
ON_THE_NETWORK: tuple[Kind, ...] = ("cut", "silent")
"""The kinds that leave the process alone."""
SERVICES = ("sensor_gateway", "pose_preprocessor", "marker_tracker", "som_classifier", "action_fusion")
"""The services, by the names under which they report."""
CAMERA_HOST = ("sensor_gateway", "marker_tracker")
"""The services on the camera's host: images never leave it."""
ROUTERS = ("camera_router", "compute_router")
LINK = "link"
"""The cable between the two hosts."""
LASTS_S = 5.0
"""How long a fault lasts (s), but for SIGKILL, after which the supervisor starts the program again."""
APART_S = 7.0
"""Least time between the beginnings of two faults (s): the first is over, and has been for two seconds."""


@dataclass(frozen=True)
class Fault:
    """What happens to whom, and when it begins (s after the run's start)."""

    victim: str
    kind: Kind
    at_s: float

    @property
    def lasts_s(self) -> float:
        """How long it goes on (s)."""
        return 0.0 if self.kind == "killed" else LASTS_S

    def __str__(self) -> str:
        return f"{self.victim} {self.kind}"


def possible() -> list[tuple[str, Kind]]:
    """List every victim with each kind of fault that can befall it."""
    return [*product((*SERVICES, *ROUTERS), KINDS), *product((LINK,), ON_THE_NETWORK)]


def drawn(seed: int, count: int, span_s: float, only: str = "") -> list[Fault]:
    """Draw faults at random moments of a span of time: each possible one before any comes again.

    The span is stretched where so many do not fit into it. With `only`, just those are drawn whose name holds it.

    Raises:
        ValueError: there is no such fault.
    """
    rng = random.Random(seed)
    wanted = [(victim, kind) for victim, kind in possible() if only in f"{victim} {kind}"]
    if not wanted:
        raise ValueError(f"no fault is called {only!r}: name a victim, a kind, or both, as 'link cut'")
    struck: list[tuple[str, Kind]] = []
    while len(struck) < count:
        struck += rng.sample(wanted, len(wanted))
    free_s = max(span_s - count * APART_S, count * APART_S / 4)
    moments_s = sorted(rng.uniform(0.0, free_s) for _ in range(count))
    chosen = rng.sample(struck[:count], count)
    return [
        Fault(victim, kind, free_s + number * APART_S)
        for number, ((victim, kind), free_s) in enumerate(zip(chosen, moments_s, strict=True))
    ]
