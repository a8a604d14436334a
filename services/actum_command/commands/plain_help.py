"""Help that says what to write as the services' own help does; Typer names Python's types."""

from collections.abc import Callable
from typing import Any, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

F = TypeVar("F", bound=Callable[..., Any])
WORDS = {"str": "TEXT", "path": "PATH", "file": "PATH", "int": "INTEGER", "float": "NUMBER", "bool": ""}
"""What is shown in place of Python's types."""


class _Plain:
    """A command or group whose parameters are shown with words of ours."""

    def get_params(self, ctx: Any) -> Any:
        """Return the parameters, each with its word."""
        params = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if hasattr(param, "display_type"):  # older versions of Typer write words by themselves
                word = _word(type(param).display_type(param, ctx))
                param.display_type = lambda _, word=word: word
        return params


class PlainCommand(_Plain, TyperCommand):
    """A command with plain help."""


class PlainGroup(_Plain, TyperGroup):
    """A group of commands with plain help."""


class PlainTyper(typer.Typer):
    """A Typer application all of whose commands have plain help."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"cls": PlainGroup} | options)

    def command(self, name: str | None = None, **options: Any) -> Callable[[F], F]:
        """Declare a command as Typer does."""
        return super().command(name, **{"cls": PlainCommand} | options)


def _word(shown: str) -> str:
    """Translate `<str>`, `<int range>` and `<list[Path]>`; what is to be chosen from stays."""
    kind = shown.strip("<>").removeprefix("list[").removesuffix("]").removesuffix(" range")
    return WORDS.get(kind.lower(), shown)
