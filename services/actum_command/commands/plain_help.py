"""Commands with the placeholders of the services' own help (TEXT, PATH) where Typer shows Python's types.

Their numbers are finite, as the services' settings are.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from actum_command.misspelt import nearest

F = TypeVar("F", bound=Callable[..., Any])
WORDS = {"str": "TEXT", "path": "PATH", "file": "PATH", "int": "INTEGER", "float": "NUMBER", "bool": ""}
"""The placeholder that is shown for each of Python's types."""


class _Plain:
    """A command or group whose parameters are shown with these placeholders."""

    def get_params(self, ctx: Any) -> Any:
        """Return the parameters, each with its placeholder."""
        params = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if hasattr(param, "display_type"):  # older versions of Typer show such placeholders themselves
                type_text = type(param).display_type(param, ctx)  # `<str>`, `<int range>` or `<list[Path]>`, or choices
                kind = type_text.strip("<>").removeprefix("list[").removesuffix("]").removesuffix(" range")
                word = WORDS.get(kind.lower(), type_text)
                param.display_type = lambda _, word=word: word
        return params


class PlainCommand(_Plain, TyperCommand):
    """A command with plain help, whose numbers are finite."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments; fail where one is a number that is not finite."""
        left = super().parse_args(ctx, args)
        for param in self.params:
            value = ctx.params.get(param.name)
            if isinstance(value, float) and not math.isfinite(value):
                raise typer.BadParameter(
                    f"{value} is not a finite number: give a finite number.", ctx, param_hint=f"'{param.opts[-1]}'"
                )
        return left


class PlainGroup(_Plain, TyperGroup):
    """A group of commands with plain help, which suggests a command only where one is really like what was typed."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.suggest_commands = False  # Typer's own suggestions are too bold

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that is named; fail where there is none, with the one that may be meant."""
        name = args[0]
        if name not in self.commands and (meant := nearest(name, self.commands)):
            ctx.fail(f"No such command '{name}'. Did you mean '{meant[0]}'?")
        return super().resolve_command(ctx, args)


LISTS = "list"
"""The command of a `ListingGroup` that need not be named."""


class ListingGroup(PlainGroup):
    """A group that lists what it is given where no command is named: `actum label REC` is `actum label list REC`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments, with the name of that command before them where none is named."""
        if args and args[0] not in (*self.commands, "--help"):
            args = [LISTS, *args]
        return super().parse_args(ctx, args)


class PlainTyper(typer.Typer):
    """A Typer application all of whose commands have plain help."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"cls": PlainGroup} | options)

    def command(self, name: str | None = None, **options: Any) -> Callable[[F], F]:
        """Declare a command as Typer does."""
        return super().command(name, **{"cls": PlainCommand} | options)
