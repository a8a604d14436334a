"""`actum label`: lists the marked segments of recordings, adds and corrects them."""

from collections.abc import Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated

import typer

from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum_command.commands.plain_help import LISTS, ListingGroup, PlainTyper
from actum_command.commands.recording_options import (
    AgentOption,
    AllOption,
    PersonOption,
    RecordingFile,
    chosen,
    refuse_label,
    tell_unread,
)
from actum_command.commands.terminal import fail, failing_on, refuse_unwritable, refuse_without, say
from actum_command.segment_lines import cut_lines, segment_lines
from actum_examples import edits
from actum_examples.marked_segment import MarkedSegment
from actum_examples.take import Take, read_take
from som_classifier.model_loading import ModelError, load_model

app = PlainTyper(
    cls=ListingGroup,
    no_args_is_help=True,
    help=(
        "List, add and correct the segments of recordings; a segment is one action with its start and end. To list the "
        "segments, run 'actum label REC…'. All times are seconds from the beginning of the recording."
    ),
)

SegmentName = Annotated[
    str,
    typer.Argument(
        metavar="SEGMENT",
        help="number or id of the segment; 'actum label REC' prints the number of each segment in the first column",
    ),
]
Label = Annotated[str, typer.Argument(metavar="LABEL", help="label of the action, such as wave")]
NewLabel = Annotated[str, typer.Argument(metavar="LABEL", help="the new label of the segment, such as wave")]


@app.command(LISTS)
def list_command(
    files: Annotated[list[Path], typer.Argument(metavar="REC...", help="recordings, or folders of recordings")],
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """List the marked segments of recordings, and whether training can use each segment.

    A segment is one action with its start and end. Each line shows the number, start, end, duration, id and label of a
    segment; then the origin of the marks, the person who acts, whether training can use the segment, and the action
    that was recognised during the recording. If the recording has several sensors, the last column names the sensor.
    """
    recordings, all_lines = chosen(files, person, with_excluded), []
    with failing_on(RecordingError):
        for recording in recordings:
            say(f"{recording.path}, person {recording.person or '(unknown)'}")
            lines = segment_lines(read_take(recording))
            for line in lines:
                say(line.text, style=None if line.usable else "yellow")
            all_lines += lines
    tell_unread(recordings)
    say(f"{len(all_lines)} segments, {sum(line.usable for line in all_lines)} usable")


@app.command("move")
def move(
    file: RecordingFile,
    name: SegmentName,
    start: Annotated[
        str | None,
        typer.Option(
            help=(
                "new start in seconds from the beginning of the recording, such as 12.3; or a shift in seconds: +0.2 "
                "moves the start 0.2 s later, -0.1 moves the start 0.1 s earlier. Default: the start is not changed"
            )
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(
            help=(
                "new end in seconds from the beginning of the recording, such as 14.1; or a shift in seconds: +0.2 "
                "moves the end 0.2 s later, -0.1 moves the end 0.1 s earlier. Default: the end is not changed"
            )
        ),
    ] = None,
) -> None:
    """Move the start or the end of a segment.

    The actions that were recognised during the recording stay unchanged.
    """
    take, segment = _found(file, name)
    start_ns = _moved_to(start, segment.start_ns, take.first_ns)
    end_ns = _moved_to(end, segment.end_ns, take.first_ns)
    with _editing(file):
        edits.move(take, segment, start_ns, end_ns)
    from_s, to_s = ((stamp_ns - take.first_ns) / SECOND_NS for stamp_ns in (start_ns, end_ns))
    say(f"{segment.segment_id} lasts from {from_s:.2f} s to {to_s:.2f} s in {file}")


@app.command("delete")
def delete(file: RecordingFile, name: SegmentName) -> None:
    """Delete a segment with its start mark, its end mark and the actions that were recognised in the segment.

    If the segment has a label, the command also deletes the frames that show the person during the segment. Frames that
    belong to another labelled segment of the same person are kept.
    """
    take, segment = _found(file, name)
    with _editing(file):
        edits.delete(take, [segment])
    say(
        f"{segment.segment_id} ({segment.label or 'no label'}) was deleted from {file}; the numbers of later segments "
        "decrease by one"
    )


@app.command("relabel")
def relabel(file: RecordingFile, name: SegmentName, label: NewLabel) -> None:
    """Change the label of a segment in a recording."""
    take, segment = _found(file, name)
    refuse_label(label)
    with _editing(file):
        edits.relabel(take, segment, label)
    say(f"{segment.segment_id} is labelled {label!r} in {file}")


@app.command("add")
def add(
    file: RecordingFile,
    start: Annotated[
        float,
        typer.Argument(metavar="START", help="start of the action, in seconds from the beginning of the recording"),
    ],
    end: Annotated[
        float, typer.Argument(metavar="END", help="end of the action, in seconds from the beginning of the recording")
    ],
    label: Label,
    agent: AgentOption = None,
) -> None:
    """Label an action in a recording by its start and end.

    Example: actum label add wave.mcap 12.3 14.1 wave
    """
    take = _opened(file)
    refuse_label(label)
    with _editing(file):
        start_ns, end_ns = (_in_ns(each, f"{each:g}", "a number of seconds such as 12.3") for each in (start, end))
        edits.add(take, take.first_ns + start_ns, take.first_ns + end_ns, label, agent)
    say(f"{label!r} from {start:.2f} s to {end:.2f} s is in {file}")


@app.command("cut")
def cut(
    file: RecordingFile,
    times: Annotated[
        int,
        typer.Argument(metavar="TIMES", min=1, help="number of times that the person does the action in the recording"),
    ],
    label: Label,
) -> None:
    """Search a recording again for the repetitions of one action, and label each repetition.

    Use this command if 'actum record --times' miscounted. The command replaces the repetitions that were found before.
    Segments that were marked or moved by hand stay unchanged.
    """
    take = _opened(file)
    refuse_label(label)
    with _editing(file):
        cuts = edits.cut_again(take, times, label)
    for line in cut_lines(cuts, take.first_ns):
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
                "a model file. The picture shows which action this model recognises in each labelled segment, and "
                "which actions it finds by itself in the whole recording. Default: the picture shows the actions that "
                "were recognised during the recording"
            )
        ),
    ] = None,
) -> None:
    """Draw the motion, the labelled segments and the recognised actions of a recording over time.

    Use the picture to check the labels.
    """
    refuse_without("matplotlib", "matplotlib, which draws the picture,", "model-inspector")
    from actum_command.recording_picture import write_picture

    refuse_unwritable(output, ".png", ".svg")
    take = _opened(file)
    with failing_on(RecordingError, ModelError, OSError):
        write_picture(take, load_model(model) if model is not None else None, output)
    say(f"{len(take.segments)} segments drawn: {output}")


def _opened(file: Path) -> Take:
    """Read a recording that has frames or marks, or fail."""
    with failing_on(RecordingError):
        take = read_take(Recording(file))
    if take.first_ns == take.last_ns and not take.segments:
        fail(f"{file} contains no skeletons and no marked actions: give a recording of a person")
    return take


def _found(file: Path, name: str) -> tuple[Take, MarkedSegment]:
    """Return a recording and its only segment of that number or id; else fail, naming those that there are."""
    take = _opened(file)
    numbers = {str(number): each for number, each in enumerate(take.segments, start=1)}
    named = {number: each for number, each in numbers.items() if name in (number, each.segment_id)}
    chosen_one = named.get(name) or next(iter(named.values()), None)
    if chosen_one is None:
        near = get_close_matches(name, [each.segment_id for each in take.segments], n=1)
        all_there = f"the recording has segments 1 to {len(numbers)}" if numbers else "the recording has no segments"
        hint = f"did you mean {near[0]}?" if near else all_there
        fail(f"there is no segment {name!r} in {file}: {hint}")
    if name not in named and len(named) > 1:
        fail(
            f"{len(named)} segments have the id {name!r}: give the number of the segment ({' or '.join(named)}) "
            "instead of this id"
        )
    return take, chosen_one


@contextmanager
def _editing(file: Path) -> Iterator[None]:
    """Fail where an edit is refused or cannot be written; the recording is then as it was."""
    try:
        yield
    except (edits.EditError, RecordingError) as error:
        fail(str(error))
    except OSError as error:
        fail(f"the recording {file} was not changed, because it cannot be written: {error.strerror}")


def _moved_to(text: str | None, now_ns: int | None, first_ns: int) -> int:
    """Return the stamp that a time means: absolute, or with a sign relative to where it is now."""
    if text is None:
        return now_ns or 0
    advice = "from the start of the recording, such as 12.3, or how far to shift the current time, such as +0.2 or -0.1"
    return ((now_ns or 0) if text[:1] in "+-" else first_ns) + _in_ns(text, f"{text!r}", f"seconds {advice}")


def _in_ns(seconds: float | str, shown: str, advice: str) -> int:
    """Return a time in nanoseconds, or fail where it is none, or beyond all numbers."""
    try:
        return round(float(seconds) * SECOND_NS)
    except (ValueError, OverflowError):
        fail(f"{shown} is not a time: give {advice}")
