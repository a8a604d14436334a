"""How a take is finished once all of its frames are stored: its examples are marked, what was not cut is taken out."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path

from actum.messages import CUT, Segment
from actum.recorder import Recorder
from actum.rewriting import rewrite, unchanged
from actum_examples.cutting.marks import free_names, marks_of
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts
from actum_examples.marked_segment import MarkedSegment
from actum_examples.stored_changes import deleted
from actum_examples.take import DOUBTS, OF_THE_TAKE, doubts_field

UNCUT = "uncut"
"""What a part of a take is called that may hold an action which was not cut."""


def finish_take(
    recorder: Recorder,
    marks: Iterable[Segment],
    doubts: Mapping[str, Sequence[str]],
    uncut: Sequence[MarkedSegment] = (),
) -> Path:
    """Close a take, and return its path.

    Args:
        recorder: of its frames.
        marks: of its examples.
        doubts: what may be wrong with them, texts by segment id.
        uncut: the parts from which whoever acts is taken out, or they would be learnt as background.

    Raises:
        OSError: it cannot be written.
    """
    recorder.close()
    rewrite(recorder.path, deleted(uncut, ()) if uncut else unchanged, marks, {DOUBTS: doubts_field(doubts)})
    return recorder.path


def uncut_parts(cuts: Cuts, asked: int | None, sensor: str) -> list[MarkedSegment]:
    """Return the parts of a take in which the person may have done the action though no example was cut of it.

    There are none where the cuts are sure and as many as were asked for: then all other movement is background.
    """
    if cuts.sureness > OTHER_NUMBER and asked in (None, len(cuts.repetitions)):
        return []
    return [
        MarkedSegment(UNCUT, sensor, start_ns, end_ns, UNCUT, CUT, cuts.course.agent)
        for start_ns, end_ns in cuts.uncut_ns
    ]


def cut_marks(cuts: Cuts, label: str, sensor: str) -> tuple[list[Segment], dict[str, list[str]]]:
    """Return the marks of what was cut, and what may be wrong with them by segment id."""
    names = list(islice(free_names((), CUT), len(cuts.repetitions)))
    doubts: dict[str, list[str]] = {}
    for text, repetition in cuts.doubted:
        doubts.setdefault(OF_THE_TAKE if repetition is None else names[repetition - 1], []).append(text)
    return marks_of(cuts, iter(names), label, sensor), doubts
