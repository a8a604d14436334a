"""`actum label`: lists the segments of a recording, draws and mends them."""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from actum.installing import adding
from actum.messages import CUT, MANUAL, segment_marks
from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum.rewriting import unchanged
from actum_command.commands.plain_help import LISTS, ListingGroup, PlainTyper
from actum_command.commands.recording_options import RecordingFile, change_recording, in_ns, refuse_length, tell_unread
from actum_command.commands.terminal import fail, refuse_ending, refuse_unwritable, say
from actum_command.cut_lines import cut_lines
from actum_command.labelled_segments import (
    LabelledSegment,
    LabellingError,
    check_span,
    cut_anew,
    first_stamp_ns,
    followed,
    labelled_segments,
    only_sensor,
    refuse_outside,
    segment_of,
)
from actum_command.segment_changes import moved, relabelled
from actum_model_trainer.cutting.marks import free_names, marks_of
from actum_model_trainer.segment_edits import deleted, fields_after, following, in_turn, without_messages
from som_classifier.model_loading import ModelError, load_model

RIGHT_ALIGNED = (True, True, True, True, False, False, False, False, False)
"""Which columns of the list hold numbers."""

app = PlainTyper(
    cls=ListingGroup,
    no_args_is_help=True,
    help=(
        "List the labelled segments of a recording (actum label REC), draw and correct them by number. Times are "
        "seconds from the start of the recording."
    ),
)

Number = Annotated[
    int, typer.Argument(metavar="N", help="number of the segment in the first column of 'actum label REC'")
]
Label = Annotated[str, typer.Argument(metavar="LABEL", help="label of the action, such as wave")]
Agent = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="track number of the person who acts (agent in the messages); default: the person nearest to the camera",
    ),
]


@app.command(LISTS)
def list_command(file: RecordingFile) -> None:
    """List the segments: number, start, end, duration, label, who marked it, who acts, the recorded answer.

    In a recording of several sensors each line ends in the sensor.
    """
    recording, segments, first_ns = _opened(file)
    say(f"{file}, person {recording.person or '(unknown)'}")
    several = len({segment.sensor for segment in segments}) > 1
    rows = [(*_row(segment, first_ns), segment.sensor if several else "") for segment in segments]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(row, widths, RIGHT_ALIGNED, strict=True)
        )
        say("  " + "  ".join(cells).rstrip())
    tell_unread([recording])
    say(f"{len(segments)} segments")


@app.command("move")
def move(
    file: RecordingFile,
    number: Number,
    start: Annotated[
        str | None,
        typer.Option(
            help="new start, such as 12.3, or relative to the old: +0.2 is later, -0.1 earlier; default: unchanged (s)"
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(
            help="new end, such as 14.1, or relative to the old: +0.2 is later, -0.1 earlier; default: unchanged (s)"
        ),
    ] = None,
) -> None:
    """Move the start or the end of a segment; the answers in the recording stay as they are."""
    recording, segments, first_ns = _opened(file)
    segment = _of_number(segments, number)
    if segment.start_ns is None or segment.end_ns is None:
        fail(
            f"segment {number} has no {('start' if segment.start_ns is None else 'end')} mark: delete the segment "
            "and add it again"
        )
    start_ns, end_ns = _moved_to(start, segment.start_ns, first_ns), _moved_to(end, segment.end_ns, first_ns)
    others = [other for other in segments if other.number != number]
    _checked(others, start_ns, end_ns, segment.sensor, segment.agent, first_ns)
    shifted = moved(segment, start_ns - segment.start_ns, end_ns - segment.end_ns)
    try:
        refuse_outside(recording, segment.sensor, start_ns, end_ns)
        frames = followed(segments, replace(segment, start_ns=start_ns, end_ns=end_ns))
    except (LabellingError, RecordingError) as error:
        fail(str(error))
    change_recording(file, in_turn(shifted, frames))
    say(f"segment {number} lasts from {_seconds(start_ns, first_ns)} to {_seconds(end_ns, first_ns)} in {file}")


@app.command("delete")
def delete(file: RecordingFile, number: Number) -> None:
    """Delete a segment: its marks, its answers and the frames of the person who acts in it.

    The frames stay if the segment has no label, or if another labelled segment of that person needs them.
    """
    recording, segments, _ = _opened(file)
    segment = _of_number(segments, number)
    kept = [other for other in segments if other.number != number]
    change_recording(file, deleted([segment], kept), metadata=fields_after(recording, kept))
    say(
        f"segment {number} ({segment.label or 'no label'}) was deleted from {file}; the numbers of later segments "
        "decrease by one"
    )


@app.command("rename")
def rename(file: RecordingFile, number: Number, label: Label) -> None:
    """Give a segment another label."""
    _, segments, _ = _opened(file)
    segment = _of_number(segments, number)
    refuse_length(label)
    if segment.start_ns is None:
        fail(f"segment {number} cannot be labelled, because it has no start mark: delete the segment")
    change_recording(file, relabelled(segment, label))
    say(f"segment {number} is labelled {label!r} in {file}")


@app.command("add")
def add(
    file: RecordingFile,
    start: Annotated[float, typer.Argument(metavar="START", help="start, from the beginning of the recording (s)")],
    end: Annotated[float, typer.Argument(metavar="END", help="end, from the beginning of the recording (s)")],
    label: Label,
    agent: Agent = None,
) -> None:
    """Add a labelled segment, such as actum label add REC 12.3 14.1 wave."""
    recording, segments, first_ns = _opened(file)
    refuse_length(label)
    start_ns, end_ns = (first_ns + in_ns(seconds) for seconds in (start, end))
    try:
        sensor = only_sensor(recording)
        refuse_outside(recording, sensor, start_ns, end_ns)
    except (LabellingError, RecordingError) as error:
        fail(str(error))
    _checked(segments, start_ns, end_ns, sensor, agent, first_ns)
    name = next(free_names([segment.segment_id for segment in segments], "added"))
    change_recording(file, unchanged, segment_marks(start_ns, end_ns, sensor, name, label, agent, origin=MANUAL))
    say(f"{label!r} from {start:.2f} s to {end:.2f} s is in {file}")


@app.command("cut")
def cut(
    file: RecordingFile,
    times: Annotated[
        int, typer.Argument(metavar="TIMES", min=1, help="number of times that the action is done in the recording")
    ],
    label: Label,
) -> None:
    """Find the repetitions of one action in the recording again, and label each.

    Use it if 'actum record --times' miscounted. Repetitions that were found before are replaced; segments marked by
    hand stay.
    """
    recording, segments, first_ns = _opened(file)
    refuse_length(label)
    try:
        cuts, sensor = cut_anew(recording, segments, times), only_sensor(recording)
    except LabellingError as error:
        fail(str(error))
    kept = [segment for segment in segments if segment.origin != CUT]
    marks = marks_of(cuts, free_names([each.segment_id for each in kept], CUT), label, sensor)
    old = without_messages(each for each in segments if each.origin == CUT)
    change_recording(file, in_turn(old, following(segments, kept)), marks, fields_after(recording, kept))
    for line in cut_lines(cuts, first_ns):
        say(line)
    for doubt in cuts.doubts:
        say(doubt, style="yellow")
    say(f"{len(cuts.repetitions)} segments labelled {label!r} are in {file}")


@app.command("picture")
def picture(
    file: RecordingFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="the picture to write (.png or .svg)")],
    model: Annotated[
        Path | None,
        typer.Option(
            help=(
                "a model file to run on the recording: draw this model's answers to the marked segments, and the "
                "segments that this model finds, in place of the recorded answers"
            )
        ),
    ] = None,
) -> None:
    """Draw the motion over time, with the labelled segments and the recorded answers, to check the labels."""
    if find_spec("matplotlib") is None:
        fail(f"matplotlib, which draws the picture, is not installed: {adding('model-inspector')}")
    from actum_command.recording_picture import write_picture

    refuse_unwritable(output)
    refuse_ending(output, ".png", ".svg")
    recording, segments, first_ns = _opened(file)
    try:
        write_picture(recording, segments, first_ns, load_model(model) if model is not None else None, output)
    except (RecordingError, ModelError, OSError) as error:
        fail(str(error))
    say(f"{len(segments)} segments drawn: {output}")


def _row(segment: LabelledSegment, first_ns: int) -> tuple[str, ...]:
    """Return the cells of a segment's line: number, start, end, duration, label, origin, agent, answer."""
    spans = (segment.start_ns, segment.end_ns)
    start, end = ("-" if stamp_ns is None else _seconds(stamp_ns, first_ns) for stamp_ns in spans)
    lasts = "-"
    if segment.start_ns is not None and segment.end_ns is not None:
        lasts = f"({(segment.end_ns - segment.start_ns) / SECOND_NS:.2f} s)"
    return (
        str(segment.number),
        start,
        end,
        lasts,
        segment.label or "(no label)",
        segment.origin or "-",
        "nearest" if segment.agent is None else f"agent {segment.agent}",
        f"answered {segment.answer}" if segment.answer else "",
    )


def _seconds(stamp_ns: int, first_ns: int) -> str:
    return f"{(stamp_ns - first_ns) / SECOND_NS:.2f} s"


def _moved_to(text: str | None, now_ns: int, first_ns: int) -> int:
    """Return the stamp that a time means: absolute, or with a sign relative to where it is now."""
    if text is None:
        return now_ns
    try:
        offset_ns = round(float(text) * SECOND_NS)
    except (ValueError, OverflowError):
        fail(f"{text!r} is not a time: give seconds such as 12.3, or a shift such as +0.2 or -0.1")
    return (now_ns if text[:1] in "+-" else first_ns) + offset_ns


def _opened(file: Path) -> tuple[Recording, list[LabelledSegment], int]:
    """Open a recording; return it, its segments and the stamp that times count from, or fail."""
    try:
        recording = Recording(file)
        return recording, labelled_segments(recording), first_stamp_ns(recording)
    except (RecordingError, LabellingError) as error:
        fail(str(error))


def _of_number(segments: list[LabelledSegment], number: int) -> LabelledSegment:
    try:
        return segment_of(segments, number)
    except LabellingError as error:
        fail(str(error))


def _checked(
    segments: list[LabelledSegment], start_ns: int, end_ns: int, sensor: str, agent: int | None, first_ns: int
) -> None:
    try:
        check_span(segments, start_ns, end_ns, sensor, agent, first_ns)
    except LabellingError as error:
        fail(str(error))
