"""Options that choose recordings and people, and warnings about the recordings that were read."""

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from actum.recorder import TakenError, refuse_taken
from actum.recording import Recording, RecordingError
from actum_command.commands.terminal import fail, failing_on, refuse_unwritable, say
from actum_model_trainer.sample_reading import select

PersonOption = Annotated[
    str | None,
    typer.Option(
        help=(
            "use only recordings of these people, such as 1,3,5; write each person's name or number as in 'actum "
            "record --person'. Default: recordings of all people"
        )
    ),
]
RecordingFile = Annotated[
    Path, typer.Argument(metavar="REC", help="the recording (.mcap)", exists=True, dir_okay=False)
]
AgentOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        help=(
            "number of the person who acts, as in the field 'agent' of messages. Default: the person nearest to the "
            "camera"
        ),
    ),
]
AllOption = Annotated[
    bool,
    typer.Option(
        "--all",
        help=(
            "also use recordings marked as excluded, such as a recording in which 'actum record --times 5' did not "
            "find 5 repetitions"
        ),
    ),
]
LONGEST_LABEL = 200  # characters allowed in the field of a mark


def chosen(files: list[Path], person: str | None, with_excluded: bool) -> list[Recording]:
    """Open the chosen recordings, and say which of a folder's are not finished; fail where there is none."""
    people = None if person is None else [name.strip() for name in person.split(",")]
    with failing_on(RecordingError):
        recordings = select(files, people, with_excluded, partial(say, style="yellow"))
    if not recordings:
        of_person = f" of person {person}" if person else ""
        hint = "" if with_excluded else ", or add --all to use recordings marked as excluded"
        places = ", ".join(map(str, files))
        fail(f"there are no recordings{of_person} in {places}: give other *.mcap files or folders{hint}")
    return recordings


def refuse_output(output: Path, ending: str = ".mcap") -> None:
    """Fail before long work where no recording can be written, or one lies already, finished or not."""
    refuse_unwritable(output, ending)
    with failing_on(TakenError):
        refuse_taken(output)


def refuse_label(label: str) -> None:
    """Fail where a label is empty, or too long for a mark."""
    if not 0 < len(label) <= LONGEST_LABEL:
        fail(f"the label has {len(label)} characters: use 1 to {LONGEST_LABEL} characters")


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
