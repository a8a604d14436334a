"""What may be wrong with some cuts, in sentences."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_examples.cutting.choice import Chain
from actum_examples.cutting.courses import RATE_HZ, Course

UNLIKE = 0.3
"""A repetition less like the most typical one is doubted: of such in MSRC-12 a sixth are none, of others one in 40."""
TWICE = 1.6
"""A repetition that takes longer than the median by this factor may be two."""
STOP = 0.5
"""Two have run together where the activity falls below this share of the repetition's mean in its middle."""
MIDDLE = 0.2
"""Share of a repetition, at its start and at its end, in which no seam of two is sought."""
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


class Doubt(NamedTuple):
    """What may be wrong, as a sentence, and with which repetition, counted from 1; None where with their number."""

    text: str
    repetition: int | None


def doubts_of(course: Course, activity: Array, chain: Chain, asked: int | None, first_ns: int) -> Iterator[Doubt]:
    """Yield what may be wrong with a chain; times count from a stamp.

    Args:
        course: what the chain was found in.
        activity: (n,), of the course.
        chain: its bursts.
        asked: the number of repetitions there should be; None where nobody knows.
        first_ns: the stamp.
    """
    offset_s, found = (course.start_ns - first_ns) / SECOND_NS, len(chain.bursts)
    seams = [
        Doubt(
            f"the {_ordinal(number)} and {_ordinal(number + 1)} repetition may be joined "
            f"at {offset_s + at / RATE_HZ:.1f} s",
            burst,
        )
        for number, burst, at in _seams(activity, chain)
    ]
    if asked is not None and found < asked:
        missing = [seam.text for seam in seams[: asked - found]]
        yield Doubt("; ".join([too_few(found, asked), *missing]), None)
    else:
        yield from seams
    for number, ((start, end), likeness) in enumerate(zip(chain.bursts, chain.likeness, strict=True), start=1):
        if found > 1 and likeness < UNLIKE:
            span = f"{offset_s + start / RATE_HZ:.1f} to {offset_s + end / RATE_HZ:.1f} s"
            yield Doubt(
                f"the {_ordinal(number)} repetition ({span}) is unlike the others: play it, and trim or delete it",
                number,
            )


def too_few(found: int, asked: int) -> str:
    """Return the doubt about a number of repetitions that is smaller than the one that was asked for."""
    return f"{found} of {asked} repetitions found: record {asked - found} more"


def _seams(activity: Array, chain: Chain) -> Iterator[tuple[int, int, int]]:
    """Yield of each burst that may be two its number as if it and those before were, its own, and where they meet."""
    lengths = chain.bursts[:, 1] - chain.bursts[:, 0]
    before = 0
    for number, (start, end) in enumerate(chain.bursts, start=1):
        edge = round(MIDDLE * (end - start))
        seam = int(start + edge + np.argmin(activity[start + edge : end - edge]))
        if end - start > TWICE * np.median(lengths) and activity[seam] < STOP * activity[start:end].mean():
            yield number + before, number, seam
            before += 1


def _ordinal(number: int) -> str:
    """Return a number as an ordinal: in letters up to the tenth."""
    return ORDINALS[number - 1] if number <= len(ORDINALS) else f"{number}th"
