"""Cuts in words and letters, for a terminal."""

from collections.abc import Iterator

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_examples.cutting.courses import RATE_HZ
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts

BARS = " ▁▂▃▄▅▆▇█"
"""Letters for an activity of 0 to `FULL`."""
FULL = 1.5
"""Activity that fills a line's height: few movements have more."""
COLUMNS = 100
"""Longest line of the course, which fits beside the usual 110 columns of a report."""


def cut_lines(cuts: Cuts, first_ns: int) -> Iterator[str]:
    """Yield the cuts as a table, then the course of the activity with the numbers of the cuts beneath.

    Args:
        cuts: what was cut.
        first_ns: stamp that times count from.
    """
    yield "  no   start     end  duration  alike"
    for number, repetition in enumerate(cuts.repetitions, start=1):
        start_s, end_s = ((stamp - first_ns) / SECOND_NS for stamp in (repetition.start_ns, repetition.end_ns))
        yield f"  {number:2}  {start_s:5.1f} s {end_s:5.1f} s    {end_s - start_s:4.1f} s   {repetition.likeness:.2f}"
    yield from (f"  {line}" for line in course_lines(cuts))
    sure = cuts.sureness > OTHER_NUMBER
    yield f"  {'sure' if sure else 'look at them'}: {cuts.sureness:.2f}"


def course_lines(cuts: Cuts) -> tuple[str, str]:
    """Return the activity over time as a line of bars, and the number of the cut beneath each."""
    columns = min(COLUMNS, len(cuts.activity))
    edges = np.linspace(0, len(cuts.activity), columns + 1).astype(int)
    heights: Array = np.maximum.reduceat(cuts.activity, edges[:-1]) / FULL * (len(BARS) - 1)
    bars = "".join(BARS[min(round(height), len(BARS) - 1)] for height in heights)
    middles_s = (edges[:-1] + edges[1:]) / 2 / RATE_HZ
    numbers = [" "] * columns
    for number, repetition in enumerate(cuts.repetitions, start=1):
        start_s, end_s = (
            (stamp - cuts.course.start_ns) / SECOND_NS for stamp in (repetition.start_ns, repetition.end_ns)
        )
        for column in np.flatnonzero((middles_s >= start_s) & (middles_s <= end_s)):
            numbers[column] = str(number % 10)
    return bars, "".join(numbers).rstrip()
