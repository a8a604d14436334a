"""What every command needs: the console, the settings, and a clear way to fail."""

import sys
from typing import NoReturn

import typer
from rich.console import Console
from rich.markup import escape

from actum.runtime import Client, RouterUnreachableError
from actum.settings import ServiceSettings

UNATTENDED_WIDTH = 110

console = Console(highlight=False, width=None if sys.stdout.isatty() else UNATTENDED_WIDTH)
errors = Console(stderr=True, highlight=False)


def settings() -> ServiceSettings:
    """Read the connection from the environment or the configuration file."""
    return ServiceSettings()


def say(message: str) -> None:
    """Print a line as it is: what looks like markup in a path or a label is not."""
    console.print(message, markup=False, soft_wrap=True)


def fail(message: str) -> NoReturn:
    """Say what went wrong and end with code 1."""
    errors.print(f"[red]actum:[/red] {escape(message)}", soft_wrap=True)
    raise typer.Exit(1)


def connect(wait_s: float = 5.0) -> Client:
    """Open a session with the router, or fail saying how to get one."""
    try:
        return Client(settings(), wait_s)
    except RouterUnreachableError as error:
        fail(str(error))
