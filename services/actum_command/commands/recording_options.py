"""Options that choose recordings, and warnings about those that were read."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from actum.recording import Recording, RecordingError
from actum_command.commands.terminal import fail, say
from actum_model_trainer.samples import select

PersonOption = Annotated[str | None, typer.Option(help="only these persons, e.g. 1,3,5")]
AllOption = Annotated[bool, typer.Option("--all", help="also recordings marked as excluded")]


def chosen(files: list[Path], person: str | None, with_excluded: bool) -> list[Recording]:
    """Open the chosen recordings; fail where there is none."""
    people = None if person is None else [name.strip() for name in person.split(",")]
    try:
        recordings = select(files, people, with_excluded)
    except RecordingError as error:
        fail(str(error))
    if not recordings:
        fail(f"no recordings of person {person or '(any)'} in {', '.join(map(str, files)) or 'nothing'}")
    return recordings


def tell_unread(recordings: Iterable[Recording]) -> None:
    """Warn of the recordings that break off, and of messages that were skipped, after recordings have been read."""
    for recording in recordings:
        if recording.truncated:
            say(f"{recording.path} breaks off: only what lies before the break was read", style="yellow")
        if recording.skipped:
            kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(recording.skipped.items()))
            say(f"{recording.path}: skipped {kinds}", style="yellow")
