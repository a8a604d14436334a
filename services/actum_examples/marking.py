"""The marks of a take's examples, and how they are stored once all of its frames are."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count, islice
from pathlib import Path

from actum.messages import CUT, Segment, segment_marks
from actum.recorder import Recorder
from actum.rewriting import rewrite, unchanged
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts
from actum_examples.marked_segment import MarkedSegment
from actum_examples.stored_changes import deleted
from actum_examples.take import DOUBTS, OF_THE_TAKE, doubts_field

UNCUT = "uncut"
"""The name of a part of a take that may show an action which was not cut."""


@dataclass(frozen=True)
class Marking:
    """The marks of a take that has ended.

    Attributes:
        marks: of its examples; None where nothing is kept.
        doubts: what may be wrong with them, texts by segment id.
        uncut: the parts from which whoever acts is removed: they may show the action, and are no background.
    """

    marks: Sequence[Segment] | None
    doubts: dict[str, list[str]] = field(default_factory=dict)
    uncut: Sequence[MarkedSegment] = ()


def marking_of(cuts: Cuts, asked: int | None, label: str, sensor: str) -> Marking:
    """Return the marks of what was cut, what may be wrong with them, and the uncut parts.

    There are no uncut parts where the cuts are sure and as many as were asked for: all other movement is background.
    """
    names = list(islice(free_names((), CUT), len(cuts.repetitions)))
    doubts: dict[str, list[str]] = {}
    for text, repetition in cuts.doubted:
        doubts.setdefault(OF_THE_TAKE if repetition is None else names[repetition - 1], []).append(text)
    complete = cuts.sureness > OTHER_NUMBER and asked in (None, len(cuts.repetitions))
    uncut = [
        MarkedSegment(UNCUT, sensor, start_ns, end_ns, UNCUT, CUT, cuts.course.agent)
        for start_ns, end_ns in ([] if complete else cuts.uncut_ns)
    ]
    return Marking(cut_marks(cuts, label, sensor), doubts, uncut)


def cut_marks(cuts: Cuts, label: str, sensor: str, taken: Collection[str] = ()) -> list[Segment]:
    """Return the marks of all repetitions, each a segment with a name that is not taken."""
    return [
        mark
        for name, each in zip(free_names(taken, CUT), cuts.repetitions, strict=False)
        for mark in segment_marks(each.start_ns, each.end_ns, sensor, name, label, cuts.course.agent, origin=CUT)
    ]


def free_names(taken: Collection[str], stem: str) -> Iterator[str]:
    """Yield names `stem-1`, `stem-2` … that are not taken yet."""
    return (name for number in count(1) if (name := f"{stem}-{number}") not in taken)


def finish_take(recorder: Recorder, marking: Marking) -> Path:
    """Finish a take: close its recorder, store marks and doubts, and remove whoever acts from the uncut parts.

    Return the path of the take.

    Raises:
        RecordingError: the file cannot be read back.
        OSError: the file cannot be written.
    """
    recorder.close()
    change = deleted(marking.uncut, ()) if marking.uncut else unchanged
    rewrite(recorder.path, change, marking.marks or (), {DOUBTS: doubts_field(marking.doubts)})
    return recorder.path
