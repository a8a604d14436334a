"""Options made from declared settings: of the router that a command talks to, and of the services that it starts."""

import inspect
import os
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Annotated, Any

import typer

from actum.command_line import explained, placeholder
from actum.settings import NodeSettings, ServiceSettings
from actum_command.service_settings import SET_BY_UP, SETTINGS, flag_of, negated_flag_of

ROUTER_VARIABLES = {"connect": "ACTUM_CONNECT", "sensor": "ACTUM_SENSOR"}
"""The settings that say which router and whose keys are meant, with their environment variables."""

SEVERAL = "--sensors"
"""Another spelling of `--sensor` where it may name several."""

Command = Callable[..., None]
"""A command's function: its parameters are the arguments and options of the command."""


def with_router_flags(command: Command, read: type[ServiceSettings] = ServiceSettings) -> Command:
    """Add the router's flags to a command; the command and the processes that it starts read their environment.

    A command that reads them as `NodeSettings` takes several sensors.
    """
    flags = {}
    for name, variable in ROUTER_VARIABLES.items():
        words: dict[str, Any] = {"help": explained(read.model_fields[name]), "envvar": variable}
        also = (SEVERAL,) if name == "sensor" and issubclass(read, NodeSettings) else ()
        flags[name] = Annotated[str | None, typer.Option(flag_of(name), *also, metavar="TEXT", **words)]

    def with_environment(values: Mapping[str, Any], arguments: Mapping[str, Any]) -> None:
        os.environ.update({ROUTER_VARIABLES[name]: value for name, value in values.items() if value is not None})
        command(**arguments)

    return _with_flags(command, flags, with_environment)


def with_flags_of(*services: str, names: tuple[str, ...] | None = None) -> Callable[[Command], Command]:
    """Return a decorator that adds to a command an option for each setting of services, or only for those in `names`.

    The command gets the values as `given`. Settings that every service has, and options that the command has already,
    are left out.
    """
    common = {*ServiceSettings.model_fields, *SET_BY_UP}

    def added_to(command: Command) -> Command:
        without = common | inspect.signature(command).parameters.keys()
        flags = {
            name: _flag(name, service)
            for service in services
            for name in names or SETTINGS[service].model_fields
            if name not in without
        }

        def with_given(values: Mapping[str, Any], arguments: Mapping[str, Any]) -> None:
            command(**arguments, given={name: value for name, value in values.items() if value not in (None, [])})

        return _with_flags(command, flags, with_given)

    return added_to


def _flag(name: str, service: str) -> Any:
    """Return a setting's option for Typer; the service validates its value."""
    field = SETTINGS[service].model_fields[name]
    words: dict[str, Any] = {"help": explained(field), "rich_help_panel": f"Settings of {service}"}
    if not placeholder(field):  # a switch
        return Annotated[bool | None, typer.Option(f"{flag_of(name)}/{negated_flag_of(name)}", **words)]
    return Annotated[list[str] | None, typer.Option(flag_of(name), metavar=placeholder(field), **words)]


def _with_flags(
    command: Command, flags: Mapping[str, Any], call: Callable[[Mapping[str, Any], Mapping[str, Any]], None]
) -> Command:
    """Return a command with more flags, annotated for Typer; `call` gets their values and the command's arguments."""
    own = [each for each in inspect.signature(command, eval_str=True).parameters.values() if each.name != "given"]
    added = [inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=flags[n]) for n in flags]

    @wraps(command)
    def with_flags(**arguments: Any) -> None:
        call({name: arguments.pop(name) for name in flags}, arguments)

    named = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in own]
    with_flags.__signature__ = inspect.Signature([*named, *added])  # type: ignore[attr-defined]
    return with_flags
