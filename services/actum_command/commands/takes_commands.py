"""`actum takes`: lists the marked actions of recordings, and changes them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated

import typer

from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum_command.commands.plain_help import LISTS, ListingGroup, PlainTyper
from actum_command.commands.recording_options import (
    AllOption,
    PersonOption,
    RecordingFile,
    change_recording,
    chosen,
    in_ns,
    refuse_length,
    tell_unread,
)
from actum_command.commands.terminal import fail, say
from actum_command.labelled_segments import (
    LabelledSegment,
    LabellingError,
    first_stamp_ns,
    followed,
    labelled_segments,
    refuse_outside,
)
from actum_command.marked_actions import MarkedAction, marked_actions
from actum_command.segment_changes import moved, relabelled
from actum_model_trainer.segment_edits import deleted, fields_after, in_turn

app = PlainTyper(
    cls=ListingGroup,
    no_args_is_help=True,
    help="List the marked actions of several recordings (actum takes REC…), and correct them by segment id.",
)

SegmentId = Annotated[
    str, typer.Argument(metavar="SEGMENT", help="segment id of the action, in the first column of 'actum takes REC'")
]
SensorOption = Annotated[
    str | None,
    typer.Option(help="sensor that recorded the action; needed only if several sensors have the same segment id"),
]


@app.command(LISTS)
def list_command(
    files: Annotated[list[Path], typer.Argument(metavar="REC...", help="recordings, or folders of them")],
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """List the marked actions: segment id, label, duration, number of frames, and whether training can use them."""
    recordings = chosen(files, person, with_excluded)
    all_actions: list[MarkedAction] = []
    try:
        for recording in recordings:
            actions = list(marked_actions(recording))
            _show(recording, actions)
            all_actions += actions
    except RecordingError as error:
        fail(str(error))
    tell_unread(recordings)
    say(f"{len(all_actions)} marked actions, {sum(action.problem is None for action in all_actions)} usable")


@app.command("relabel")
def relabel(
    file: RecordingFile,
    segment_id: SegmentId,
    label: Annotated[str, typer.Argument(metavar="LABEL", help="new label of the action")],
    sensor: SensorOption = None,
) -> None:
    """Give an action another label."""
    refuse_length(label)
    segment = _marked(file, segment_id, sensor).segment
    if segment.start_ns is None:
        fail(
            f"{segment_id} in {file} cannot be labelled, because it has no start mark: delete the action with "
            "'actum takes drop'"
        )
    change_recording(file, relabelled(segment, label))
    say(f"{segment_id} is labelled {label!r} in {file}")


@app.command("trim")
def trim(
    file: RecordingFile,
    segment_id: SegmentId,
    start: Annotated[
        float, typer.Option(help="new start, counted from the present start; a negative value is earlier (s)")
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option(help="new end, counted from the present start; default: unchanged (s)")
    ] = None,
    sensor: SensorOption = None,
) -> None:
    """Move the start and the end of an action, such as actum takes trim REC a1 --start 0.2 --end 1.5.

    Both times count from the present start of the action (s).
    """
    marked = _marked(file, segment_id, sensor)
    start_ns, end_ns = marked.segment.start_ns, marked.segment.end_ns
    if start_ns is None or end_ns is None:
        fail(
            f"{segment_id} has no {('start' if start_ns is None else 'end')} mark in {file}: delete the action "
            "with 'actum takes drop'"
        )
    duration_s = (end_ns - start_ns) / SECOND_NS
    until_s = duration_s if end is None else end
    if start >= until_s:
        fail(
            f"{segment_id} would run from {start:g} s to {until_s:g} s, counted from its present start: the end has to "
            "be later than the start"
        )
    if start_ns + start * SECOND_NS < 0:
        fail(
            f"{segment_id} would start before time 0 of the sensor's clock: move the start by at most "
            f"{start_ns / SECOND_NS:g} s earlier"
        )
    _shift(file, marked, in_ns(start), in_ns(until_s - duration_s))
    say(f"{segment_id} now lasts {until_s - start:.2f} s (before: {duration_s:.2f} s) in {file}")


@app.command("drop")
def drop(file: RecordingFile, segment_id: SegmentId, sensor: SensorOption = None) -> None:
    """Delete an action: its marks, its answers and the frames of the person who acts in it.

    The frames stay if the action has no label, or if another labelled action of that person needs them.
    """
    marked = _marked(file, segment_id, sensor)
    kept = [other for other in marked.segments if other is not marked.segment]
    change_recording(file, deleted([marked.segment], kept), metadata=fields_after(marked.recording, kept))
    say(f"{segment_id} was deleted from {file}")


def _show(recording: Recording, actions: Sequence[MarkedAction]) -> None:
    """Print a recording's actions below its name, in columns as wide as their longest text."""
    say(f"{recording.path}, person {recording.person or '(unknown)'}")
    if not actions:
        say("  no marked action")
    columns: tuple[Callable[[MarkedAction], str], ...] = (
        lambda action: action.segment_id,
        lambda action: action.label or "(no label)",
    )
    widths = [max((len(cell(action)) for action in actions), default=0) for cell in columns]
    several = len({action.sensor for action in actions}) > 1
    for action in actions:
        words = "  ".join(cell(action).ljust(width) for cell, width in zip(columns, widths, strict=True))
        usable = "usable" if action.problem is None else f"not usable: {action.problem}"
        usable += f", {action.sensor}" if several else ""
        line = f"  {words}  {action.duration_s:6.2f} s  {action.frames:4} frames  {usable}"
        say(line, style=None if action.problem is None else "yellow")


@dataclass(frozen=True)
class _Marked:
    """A marked segment, with the recording and all segments that it is one of."""

    recording: Recording
    segments: list[LabelledSegment]
    segment: LabelledSegment


def _marked(file: Path, segment_id: str, sensor: str | None) -> _Marked:
    """Return the only segment of that name, at that sensor if one is named; else fail, naming those that there are."""
    try:
        recording = Recording(file)
        segments = labelled_segments(recording)
        named = [each for each in segments if each.segment_id == segment_id and sensor in (None, each.sensor)]
        if len(named) > 1:
            fail(_several(named, first_stamp_ns(recording)))
    except (RecordingError, LabellingError) as error:
        fail(str(error))
    if not named:
        names = [each.segment_id for each in segments if sensor in (None, each.sensor)]
        near = get_close_matches(segment_id, names, n=1) or names[:5]
        where = f"{segment_id!r} of {sensor}" if sensor is not None else repr(segment_id)
        fail(f"no {where} in {file}" + (f": is {' or '.join(near)} meant?" if near else ": nothing is marked"))
    return _Marked(recording, segments, named[0])


def _shift(file: Path, marked: _Marked, later_start_ns: int, later_end_ns: int) -> None:
    """Shift the marks of a segment that has both (ns, positive is later), and let its frames follow; or fail."""
    segment = marked.segment
    assert segment.start_ns is not None and segment.end_ns is not None
    start_ns, end_ns = segment.start_ns + later_start_ns, segment.end_ns + later_end_ns
    try:
        refuse_outside(marked.recording, segment.sensor, start_ns, end_ns)
        frames = followed(marked.segments, replace(segment, start_ns=start_ns, end_ns=end_ns))
    except (LabellingError, RecordingError) as error:
        fail(str(error))
    change_recording(file, in_turn(moved(segment, later_start_ns, later_end_ns), frames))


def _several(named: Sequence[LabelledSegment], first_ns: int) -> str:
    """Say which segments have one name, and how to name one of them."""
    spans = [
        [
            f"{(stamp_ns - first_ns) / SECOND_NS:.2f}"
            for stamp_ns in (each.start_ns, each.end_ns)
            if stamp_ns is not None
        ]
        for each in named
    ]
    there = ", ".join(f"{each.sensor} from {' to '.join(span)} s" for each, span in zip(named, spans, strict=True))
    sensors = {each.sensor for each in named}
    todo = "name one with --sensor" if len(sensors) == len(named) else "use 'actum label', which numbers the segments"
    return f"{len(named)} segments are named {named[0].segment_id!r} ({there}): {todo}"
