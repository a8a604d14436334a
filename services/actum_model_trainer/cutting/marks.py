"""The marks of what was cut."""

from collections.abc import Collection, Iterator

from actum.messages import CUT, Segment
from actum_model_trainer.cutting.repetitions import Cuts


def marks_between(
    sensor: str, segment_id: str, start_ns: int, end_ns: int, label: str, agent: int | None, origin: str
) -> list[Segment]:
    """Return the start and the end mark of a new segment."""
    names = {"sensor": sensor, "segment_id": segment_id, "agent": agent, "origin": origin}
    return [
        Segment.model_validate({"kind": "start", "stamp_ns": start_ns, "label": label, **names}),
        Segment.model_validate({"kind": "end", "stamp_ns": end_ns, **names}),
    ]


def marks_of(cuts: Cuts, names: Iterator[str], label: str, sensor: str) -> list[Segment]:
    """Return the marks of all repetitions, each a segment with the next of the names."""
    return [
        mark
        for name, each in zip(names, cuts.repetitions, strict=False)
        for mark in marks_between(sensor, name, each.start_ns, each.end_ns, label, cuts.course.agent, CUT)
    ]


def free_names(taken: Collection[str], stem: str) -> Iterator[str]:
    """Yield names `stem-1`, `stem-2` … that are not taken yet."""
    number = 0
    while True:
        number += 1
        if f"{stem}-{number}" not in taken:
            yield f"{stem}-{number}"
