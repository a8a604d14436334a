"""Functions that all commands share: the console, the settings, a session with the router, and a clear way to fail."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile
from typing import NoReturn

import typer
from rich.console import Console, ConsoleOptions, RenderableType
from rich.markup import escape
from rich.segment import Segment

from actum.atomic_file import write_whole
from actum.installing import install_command
from actum.runtime import Client, RouterUnreachableError, obstacle
from actum.settings import ServiceSettings, SettingsError, complaint

UNATTENDED_WIDTH = 110  # characters, where the output goes to no terminal: enough for every table

CONTROLS = dict.fromkeys(
    [*range(ord("\n")), *range(ord("\n") + 1, 0x20), *range(0x7F, 0xA0)], "\N{REPLACEMENT CHARACTER}"
)
"""Replaces the characters by which a text could move the cursor, clear the screen or set the window's title."""


class LiteralConsole(Console):
    """A console that never obeys the text that it prints: labels and reasons come from files and from the network."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Yield the segments of a renderable, with each control character in its texts replaced."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=segment.text.translate(CONTROLS))


console = LiteralConsole(highlight=False, emoji=False, width=None if sys.stdout.isatty() else UNATTENDED_WIDTH)
errors = LiteralConsole(stderr=True, highlight=False, emoji=False)


def settings(kind: type[ServiceSettings] = ServiceSettings) -> ServiceSettings:
    """Read the connection from the environment or the configuration file, or fail saying what cannot be used."""
    try:
        return kind()
    except ValueError as error:
        fail(complaint(error))


def say(message: str, style: str | None = None) -> None:
    """Print a line literally: nothing in a path or a label is taken for markup."""
    console.print(message, markup=False, soft_wrap=True, style=style)


def fail(message: str) -> NoReturn:
    """Say what went wrong and end with code 1."""
    errors.print(f"[red]actum:[/red] {escape(message)}", soft_wrap=True)
    raise typer.Exit(1)


@contextmanager
def failing_on(*errors: type[Exception]) -> Iterator[None]:
    """Return a context that ends the command with the text of an error of these kinds."""
    try:
        yield
    except errors as error:
        fail(_in_words(error))


def _in_words(error: Exception) -> str:
    """Return an error's text; where the operating system gave the error, without its number and with what to do."""
    if not isinstance(error, OSError) or not str(error).startswith("["):
        return str(error)
    path = error.filename2 or error.filename
    if path is None:
        return f"{error.strerror}: solve this problem, then try again"
    return f"{path} cannot be used ({error.strerror}): solve this problem, or name another file or folder"


def connect(wait_s: float = 5.0, here: ServiceSettings | None = None) -> Client:
    """Open a session with the router, or fail saying why there is none and how to get one."""
    here = here or settings()
    try:
        return Client(here, wait_s)
    except RouterUnreachableError as error:
        reason = obstacle(here)
        fail(f"no router answers at {here.connect}: {reason}" if reason else str(error))
    except SettingsError as error:
        fail(str(error))


def connect_whenever() -> Client:
    """Open a session with the router, waiting without limit; print that it waits."""
    here = settings()
    try:
        return Client(here, wait_s=0)
    except RouterUnreachableError:
        say(f"there is no router at {here.connect} yet: waiting for a router")
    except SettingsError as error:
        fail(str(error))
    return connect(wait_s=float("inf"))


def refuse_without(module: str, what: str, extra: str) -> None:
    """Fail where a library is not installed; `what` begins the sentence and names the library."""
    if find_spec(module) is None:
        fail(f"{what} is not installed: run {install_command(extra)}")


def refuse_ending(file: Path, *endings: str) -> None:
    """Fail where the name of a file to write has none of these endings."""
    if file.suffix.lower() not in endings:
        name = file.name.removesuffix(file.suffix) + endings[0]
        better = file.with_name(name) if file.name else name
        fail(f"{file} does not end in {' or '.join(endings)}: name the file {better}")


def write_text(file: Path, text: str) -> None:
    """Write a text file and the folders it lies in, or fail and leave the one that is there."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file.resolve(), text.encode())
    except OSError as error:
        fail(f"{file} cannot be written ({error.strerror}): give another file")


def refuse_unwritable(file: Path, *endings: str) -> None:
    """Fail before long work where a file of these endings could not be written; missing folders will be made."""
    try:
        if file.is_dir():
            fail(f"{file} is a folder: give the name of a file")
        with TemporaryFile(dir=next(folder for folder in file.absolute().parents if folder.exists())):
            pass
    except OSError as error:
        fail(f"{file} cannot be written ({error.strerror}): give another file")
    if endings:
        refuse_ending(file, *endings)
