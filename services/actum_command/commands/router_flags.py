"""The flags of commands that talk to a router: its endpoint, and the sensor whose keys are meant."""

import inspect
import os
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

from actum.settings import ServiceSettings
from actum_command.service_settings import flag_of

NAMES = ("connect", "sensor")
"""The settings of every service that these commands have as flags."""


def with_router_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Add these flags to a command; the command and the processes that it starts find them in the environment."""
    parameters = inspect.signature(command, eval_str=True).parameters
    flags = [_flag(name) for name in NAMES if name not in parameters]

    @wraps(command)
    def with_environment(**arguments: Any) -> None:
        for flag in flags:
            value = arguments.pop(flag.name)
            if value is not None:
                os.environ[_variable(flag.name)] = value
        command(**arguments)

    named = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in parameters.values()]
    with_environment.__signature__ = inspect.Signature([*named, *flags])  # type: ignore[attr-defined]
    return with_environment


def _flag(name: str) -> inspect.Parameter:
    words: dict[str, Any] = {"help": ServiceSettings.model_fields[name].description, "envvar": _variable(name)}
    annotation = Annotated[str | None, typer.Option(flag_of(name), metavar="TEXT", **words)]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)


def _variable(name: str) -> str:
    return f"ACTUM_{name.upper()}"
