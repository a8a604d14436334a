"""A number of hostile messages at one service, and what became of them and of its memory."""

import gc
import tempfile
import time
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from random import Random

from actum import codec
from actum.node import TICK_NS, Tick
from fuzzing.mutations import mutated
from fuzzing.targets import TARGETS, Target

SPOILED = 0.6
"""Share of the messages with something wrong; those between keep the streams going."""
BESIDE = 0.1
"""Share of commands, of browsers' orders and of another system's payloads, where a service takes such."""
TICKS = 0.02
PAGE_BYTES = 4096
FLAT_BYTES = 48_000_000
"""Growth of resident memory over the second half that is the allocator's, and no leak."""


@dataclass(frozen=True)
class Outcome:
    """What a service made of hostile messages.

    Attributes:
        service: its name.
        messages: how many it was sent, commands and the like among them.
        rejects: how often it counted something.
        kinds: how many kinds of rejects there were.
        grown_bytes: the growth of resident memory from half of the messages to all.
        resident_bytes: resident memory at the end.
        seconds: how long it took.
    """

    service: str
    messages: int
    rejects: int
    kinds: int
    grown_bytes: int
    resident_bytes: int
    seconds: float

    @property
    def flat(self) -> bool:
        """Whether memory stayed."""
        return self.grown_bytes < FLAT_BYTES


class CrashError(AssertionError):
    """A service that raised anything on what it was sent; the text says how to see it again."""


def run(service: str, messages: int, seed: int) -> Outcome:
    """Send a service real, spoiled and hostile messages.

    Raises:
        CrashError: the service raised an error.
    """
    rng = Random(f"{seed} {service}")
    with tempfile.TemporaryDirectory() as folder:
        target = TARGETS[service](Path(folder))
        began_s, half_bytes, sent = time.monotonic(), 0, 0
        for lap in count():
            frames = [codec.encode(message) for message in target.real(lap)]
            for frame in frames:
                try:
                    _send(target, rng, frame, frames)
                except Exception as error:
                    raise CrashError(
                        f"{service}, seed {seed}, message {sent}, {type(error).__name__}: {error}"
                    ) from error
                sent += 1
                if sent == messages // 2:
                    half_bytes = measured_bytes()
                if sent == messages:
                    return _outcome(target, sent, half_bytes, began_s)
    raise AssertionError


def _send(target: Target, rng: Random, frame: codec.Frame, frames: list[codec.Frame]) -> None:
    chance = rng.random()
    if chance < TICKS:
        target.handle(Tick(rng.choice((rng.randrange(2**62), rng.randrange(1000) * TICK_NS))))
    elif chance < TICKS + BESIDE and target.commands:
        target.ask(rng)
    elif chance < TICKS + BESIDE and target.foreign:
        target.take_foreign(rng)
    else:
        target.put(mutated(rng, frame, frames) if chance < TICKS + BESIDE + SPOILED else frame)


def _outcome(target: Target, sent: int, half_bytes: int, began_s: float) -> Outcome:
    now_bytes, rejects = measured_bytes(), target.counters.rejects
    seconds = time.monotonic() - began_s
    return Outcome(
        target.name, sent, sum(rejects.values()), len(rejects), now_bytes - half_bytes, now_bytes, seconds
    )  # fmt: skip


def measured_bytes() -> int:
    """Return this process's resident memory once garbage is collected; 0 where the system does not tell."""
    gc.collect()
    told = Path("/proc/self/statm")
    return int(told.read_text().split()[1]) * PAGE_BYTES if told.exists() else 0
