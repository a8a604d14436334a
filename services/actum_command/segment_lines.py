"""Segments as lines for a terminal: those of a recording, and the repetitions that were cut from one."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from actum import keys
from actum.arrays import Array
from actum.messages import Action, Event
from actum.node import SECOND_NS
from actum_examples.cutting.courses import RATE_HZ
from actum_examples.cutting.repetitions import OTHER_NUMBER, Cuts
from actum_examples.marked_segment import MarkedSegment
from actum_examples.take import Take
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, why_unusable
from som_classifier.segments import ClosedSegment

SIDES = ">>>><<<<<<<"
"""How each column is aligned: the first ones hold numbers, which are aligned at their ends."""
BARS = " ▁▂▃▄▅▆▇█"
"""Letters for an activity of 0 to `FULL`."""
FULL = 1.5
"""Activity that fills a line's height: few movements have more."""
COLUMNS = 100
"""Longest line of the course, which fits beside the usual 110 columns of a report."""


@dataclass(frozen=True)
class SegmentLine:
    """One line, and whether training can use the segment."""

    text: str
    usable: bool


def segment_lines(take: Take) -> list[SegmentLine]:
    """Return a line for each segment, in columns as wide as their longest cell.

    Raises:
        RecordingError: the file is damaged.
    """
    answers = _answers(take)
    problems = _problems(take)  # the last pass over the recording, which counts what is skipped of frames and marks
    several = len({each.sensor for each in take.segments}) > 1
    rows = [
        (
            str(number),
            *_times(each, take.first_ns),
            each.segment_id,
            each.label or "(no label)",
            each.origin or "-",
            "nearest" if each.agent is None else f"agent {each.agent}",
            f"not usable: {problem}" if problem else "usable",
            _answer_to(each, answers),
            each.sensor if several else "",
        )
        for number, (each, problem) in enumerate(zip(take.segments, problems, strict=True), start=1)
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row, problem in zip(rows, problems, strict=True):
        cells = [f"{cell:{side}{width}}" for cell, side, width in zip(row, SIDES, widths, strict=True)]
        lines.append(SegmentLine("  " + "  ".join(cells).rstrip(), problem is None))
    return lines


def _times(segment: MarkedSegment, first_ns: int) -> tuple[str, str, str]:
    start, end = (
        "-" if stamp_ns is None else f"{(stamp_ns - first_ns) / SECOND_NS:.2f} s"
        for stamp_ns in (segment.start_ns, segment.end_ns)
    )
    if segment.bounds_ns is None:
        return start, end, "-"
    return start, end, f"({(segment.bounds_ns[1] - segment.bounds_ns[0]) / SECOND_NS:.2f} s)"


def _problems(take: Take) -> list[str | None]:
    """Return for each segment why it cannot be trained on, None where it can."""
    closed: defaultdict[tuple[str, str], list[ClosedSegment]] = defaultdict(list)
    for sensor in {each.sensor for each in take.segments}:
        for each in closed_segments(classifier_input(take.recording, sensor)):
            closed[sensor, each.segment_id].append(each)
    return [_problem(each, closed[each.sensor, each.segment_id]) for each in take.segments]


def _problem(segment: MarkedSegment, closed: list[ClosedSegment]) -> str | None:
    """Return why a segment cannot be trained on; takes the first of the closed ones of its name."""
    if segment.start_ns is None:
        return "end without start"
    if not closed:
        return "no frame in it"
    return why_unusable(closed.pop(0)) or ("no label" if segment.label is None else None)


def _answers(take: Take) -> list[Action | Event]:
    messages = take.recording.messages((keys.SEGMENT, keys.ACTION, keys.EVENT))
    return [each for each in messages if isinstance(each, Event) or (isinstance(each, Action) and each.final)]


def _answer_to(segment: MarkedSegment, answers: Sequence[Action | Event]) -> str:
    """Return the last answer to a segment, or, where none names it, the answer that shares most of its time."""
    own = [answer for answer in answers if segment.has(answer)]
    if own or segment.bounds_ns is None:
        return _in_words(own[-1]) if own else ""
    start_ns, end_ns = segment.bounds_ns
    shared_ns = {
        index: min(answer.end_ns or answer.start_ns, end_ns) - max(answer.start_ns, start_ns)
        for index, answer in enumerate(answers)
        if answer.sensor == segment.sensor
    }
    best = max(shared_ns, key=lambda index: shared_ns[index], default=None)
    return _in_words(answers[best]) if best is not None and shared_ns[best] > 0 else ""


def _in_words(answer: Action | Event) -> str:
    if not answer.valid or answer.action is None:
        return "answered rejected"
    return f"answered {answer.action} {answer.confidence:.2f}" + (" (unknown)" if answer.unknown else "")


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
