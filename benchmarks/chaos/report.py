"""The report of a run, as a table for the terminal."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from .faults import KINDS, LINK, ROUTERS, SERVICES
from .hearing import Heard
from .judge import ALLOWED, Judged, Judgement
from .recovery import Strike

HEADER = "                     faults  met by  right  rejected  violations   p50 s   p99 s  never"
"""Segments that met a fault, and what became of them; recovery times (s); faults after which not all worked again."""


def report(judgement: Judgement, strikes: Sequence[Strike], heard: Heard) -> Iterator[str]:
    """Yield the lines: faults by kind and by victim with the segments that met them, answers, and violations."""
    yield HEADER
    for kind in KINDS:
        yield _row(kind, judgement, strikes, lambda strike, kind=kind: strike.fault.kind == kind)
    yield ""
    for victim in (*SERVICES, *ROUTERS, LINK):
        yield _row(victim, judgement, strikes, lambda strike, victim=victim: strike.fault.victim == victim)
    yield ""
    yield _row("all", judgement, strikes, lambda strike: True)
    alone = [each for each in judgement.segments if not each.met]
    yield f"{'met no fault':27}{len(alone):8}" + _counts(alone)
    yield from _answers(judgement, heard)
    yield from (f"violation: {line}" for line in judgement.violations)


def _row(name: str, judgement: Judgement, strikes: Sequence[Strike], of_it: Callable[[Strike], bool]) -> str:
    chosen = [strike for strike in strikes if of_it(strike)]
    met = [each for each in judgement.segments if any(of_it(strike) for strike in each.met)]
    recovered = [strike.recovery_s for strike in chosen if strike.recovery_s is not None]
    percentiles = np.percentile(recovered, (50, 99)) if recovered else ()
    times = "".join(f"{each:8.2f}" for each in percentiles) or f"{'-':>8}{'-':>8}"
    return f"{name:20}{len(chosen):7}{len(met):8}{_counts(met)}{times}{len(chosen) - len(recovered):7}"


def _counts(segments: Sequence[Judged]) -> str:
    verdicts = Counter(each.verdict for each in segments)
    bad = sum(count for verdict, count in verdicts.items() if verdict not in ALLOWED)
    return f"{verdicts['right']:7}{verdicts['rejected']:10}{bad:12}"


def _answers(judgement: Judgement, heard: Heard) -> Iterator[str]:
    verdicts = Counter(each.verdict for each in judgement.segments)
    yield f"marked segments: {len(judgement.segments)}: " + ", ".join(f"{n} {name}" for name, n in verdicts.items())
    reasons = Counter(each.detail for each in judgement.segments if each.verdict == "rejected")
    yield from (f"  {count} {reason}" for reason, count in reasons.most_common())
    latencies = [each.latency_s for each in judgement.segments if each.latency_s is not None]
    if latencies:
        p50, p99 = np.percentile(latencies, (50, 99))
        yield f"answered after the end mark: p50 {p50:.2f} s, p99 {p99:.2f} s"
    yield f"found without marks: {len(judgement.found)}, of which {judgement.found_though_marked} were marked as well"
    yield f"answers repeated with the same content: {heard.repeats}"
