"""The marks of what was cut."""

from collections.abc import Collection, Iterator

from actum.messages import CUT, Segment, segment_marks
from actum_examples.cutting.repetitions import Cuts


def marks_of(cuts: Cuts, names: Iterator[str], label: str, sensor: str) -> list[Segment]:
    """Return the marks of all repetitions, each a segment with the next of the names."""
    return [
        mark
        for name, each in zip(names, cuts.repetitions, strict=False)
        for mark in segment_marks(each.start_ns, each.end_ns, sensor, name, label, cuts.course.agent, origin=CUT)
    ]


def free_names(taken: Collection[str], stem: str) -> Iterator[str]:
    """Yield names `stem-1`, `stem-2` … that are not taken yet."""
    number = 0
    while True:
        number += 1
        if f"{stem}-{number}" not in taken:
            yield f"{stem}-{number}"
