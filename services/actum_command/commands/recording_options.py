"""Options that choose recordings, warnings about those that were read, and how one is changed."""

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from actum.node import SECOND_NS
from actum.recorder import TakenError, refuse_taken
from actum.recording import Recording, RecordingError
from actum_command.commands.terminal import fail, refuse_ending, refuse_unwritable, say
from actum_model_trainer.samples import select

PersonOption = Annotated[
    str | None,
    typer.Option(
        help=(
            "use only recordings of these people, named as in 'actum record --person', such as 1,3,5; default: "
            "recordings of everybody"
        )
    ),
]
RecordingFile = Annotated[
    Path, typer.Argument(metavar="REC", help="the recording (.mcap)", exists=True, dir_okay=False)
]
AllOption = Annotated[
    bool,
    typer.Option(
        "--all",
        help=(
            "also use recordings marked as excluded, such as those in which 'actum record --times N' did not find N "
            "repetitions"
        ),
    ),
]

LONGEST_LABEL = 200  # characters allowed in the field of a mark


def chosen(files: list[Path], person: str | None, with_excluded: bool) -> list[Recording]:
    """Open the chosen recordings, and say which of a folder's are not finished; fail where there is none."""
    people = None if person is None else [name.strip() for name in person.split(",")]
    try:
        recordings = select(files, people, with_excluded, partial(say, style="yellow"))
    except RecordingError as error:
        fail(str(error))
    if not recordings:
        of_person = f" of person {person}" if person else ""
        hint = "" if with_excluded else ", or add --all to use recordings marked as excluded"
        places = ", ".join(map(str, files))
        fail(f"there are no recordings{of_person} in {places}: give other *.mcap files or folders{hint}")
    return recordings


def refuse_output(output: Path, ending: str = ".mcap") -> None:
    """Fail before long work where no recording can be written, or one lies already, finished or not."""
    refuse_unwritable(output)
    refuse_ending(output, ending)
    try:
        refuse_taken(output)
    except TakenError as error:
        fail(str(error))


def tell_unread(recordings: Iterable[Recording]) -> None:
    """Warn of the recordings that break off, and of messages that were skipped, after recordings have been read."""
    for line in unread(recordings):
        say(line, style="yellow")


def unread(recordings: Iterable[Recording]) -> Iterator[str]:
    """Yield a line for each recording that breaks off, or of which messages were skipped."""
    for recording in recordings:
        if recording.truncated:
            yield f"{recording.path} is truncated: only the messages before that point were read"
        if recording.skipped:
            kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(recording.skipped.items()))
            yield f"{recording.path}: skipped {kinds}"


def refuse_length(label: str) -> None:
    """Fail where a label is empty, or too long for a mark."""
    if not 0 < len(label) <= LONGEST_LABEL:
        fail(f"the label must have 1 to {LONGEST_LABEL} characters")


def in_ns(seconds: float) -> int:
    """Return a time in nanoseconds, or fail where it is beyond all numbers."""
    try:
        return round(seconds * SECOND_NS)
    except (ValueError, OverflowError):
        fail(f"{seconds:g} is not a time: give a number of seconds such as 12.3")
