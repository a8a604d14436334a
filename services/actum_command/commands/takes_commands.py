"""`actum takes`: lists the marked actions of recordings, and changes them."""

from collections.abc import Callable, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any

import typer

from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum.rewriting import Change, rewrite
from actum_command.commands.plain_help import PlainGroup, PlainTyper
from actum_command.commands.recording_options import AllOption, PersonOption, chosen, tell_unread
from actum_command.commands.terminal import fail, say
from actum_command.marked_actions import MarkedAction, bounds_ns, dropped, marked_actions, relabelled, trimmed

LISTS = "list"
"""The default command of `actum takes`."""

LONGEST_LABEL = 200  # characters allowed in the field of a mark


class _ListsByDefault(PlainGroup):
    """`actum takes REC…` is `actum takes list REC…`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if args and args[0] not in (*self.commands, "--help"):
            args = [LISTS, *args]
        return super().parse_args(ctx, args)


app = PlainTyper(
    cls=_ListsByDefault,
    no_args_is_help=True,
    help="List the marked actions of recordings, actum takes REC…, and mend them.",
)

Rec = Annotated[Path, typer.Argument(metavar="REC", help="the recording", exists=True, dir_okay=False)]
SegmentId = Annotated[str, typer.Argument(metavar="SEGMENT", help="the action, as the list names it")]


@app.command(LISTS)
def list_command(
    files: Annotated[list[Path], typer.Argument(metavar="REC...", help="recordings, or folders of them")],
    person: PersonOption = None,
    with_excluded: AllOption = False,
) -> None:
    """List the marked actions: segment, label, how long, how many frames, usable for training or why not."""
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
    file: Rec, segment_id: SegmentId, label: Annotated[str, typer.Argument(metavar="LABEL", help="what it is")]
) -> None:
    """Give an action another label."""
    if not 0 < len(label) <= LONGEST_LABEL:
        fail(f"a label has 1 to {LONGEST_LABEL} characters")
    if _bounds(file, segment_id)[0] is None:
        fail(f"{segment_id} has no start mark in {file}, which a label belongs to: drop it")
    _rewrite(file, relabelled(segment_id, label))
    say(f"{segment_id} is labelled {label!r} in {file}")


@app.command("trim")
def trim(
    file: Rec,
    segment_id: SegmentId,
    start: Annotated[
        float, typer.Option(help="where it is to start, in seconds from its present start; negative is earlier")
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option(help="where it is to end, in seconds from its present start; default: where it does")
    ] = None,
) -> None:
    """Move the start and the end of an action; times count from its present start."""
    start_ns, end_ns = _bounds(file, segment_id)
    if start_ns is None or end_ns is None:
        fail(f"{segment_id} has no {'start' if start_ns is None else 'end'} mark in {file}: drop it")
    duration_s = (end_ns - start_ns) / SECOND_NS
    until_s = duration_s if end is None else end
    if start >= until_s:
        fail(f"{segment_id} would start at {start:g} s and end at {until_s:g} s of its {duration_s:g} s")
    if start_ns + start * SECOND_NS < 0:
        fail(f"{segment_id} would start before its sensor's clock does: at the most {start_ns / SECOND_NS:g} s earlier")
    _rewrite(file, trimmed(segment_id, round(start * SECOND_NS), round((until_s - duration_s) * SECOND_NS)))
    say(f"{segment_id} lasts {until_s - start:.2f} s, and lasted {duration_s:.2f} s before, in {file}")


@app.command("drop")
def drop(file: Rec, segment_id: SegmentId) -> None:
    """Take an action out: its marks and what was answered; the frames stay."""
    _bounds(file, segment_id)
    _rewrite(file, dropped(segment_id))
    say(f"{segment_id} is no longer in {file}")


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
    for action in actions:
        words = "  ".join(cell(action).ljust(width) for cell, width in zip(columns, widths, strict=True))
        usable = "usable" if action.problem is None else f"not usable: {action.problem}"
        line = f"  {words}  {action.duration_s:6.2f} s  {action.frames:4} frames  {usable}"
        say(line, style=None if action.problem is None else "yellow")


def _bounds(file: Path, segment_id: str) -> tuple[int | None, int | None]:
    """Return the stamps (ns) of a segment's start and end marks; fail, naming similar segments, where it has none."""
    try:
        recording = Recording(file)
        marks_ns = bounds_ns(recording, segment_id)
        if marks_ns == (None, None):
            names = [action.segment_id for action in marked_actions(recording)]
            near = get_close_matches(segment_id, names, n=1) or names[:5]
            fail(
                f"no {segment_id!r} in {file}" + (f": is {' or '.join(near)} meant?" if near else ": nothing is marked")
            )
    except RecordingError as error:
        fail(str(error))
    return marks_ns


def _rewrite(file: Path, change: Change) -> None:
    try:
        rewrite(file, change)
    except RecordingError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{file} cannot be written anew ({error.strerror}); it is as it was")
