"""Options for every setting of the services that a command starts, made from the services' declarations."""

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Annotated, Any

import typer
from pydantic.fields import FieldInfo

from actum.command_line import explained, placeholder
from actum.settings import ServiceSettings
from actum_command.search_settings import CLASSIFIER, SEARCH_SETTINGS
from actum_command.service_settings import BRIDGE, DECLARED, HISTORY, SET_BY_UP, SETTINGS, flag_of, negated_flag_of


def with_service_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Add to a command an option for each setting of the services that `actum up` starts and that it lacks.

    It gets their values as `given`.
    """
    return _with_flags(command, (flag for service in DECLARED for flag in _own(service)))


def with_bridge_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Add to a command an option for each setting of the bridge to ROS 2; it gets their values as `given`."""
    return _with_flags(command, _own(BRIDGE))


def with_history_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Add to a command an option for each setting of the service that keeps events; it gets their values as `given`."""
    return _with_flags(command, _own(HISTORY))


def with_search_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Add to a command an option for each setting of the search for actions; it gets their values as `given`."""
    return _with_flags(command, ((CLASSIFIER, name) for name in SEARCH_SETTINGS))


def _own(service: str) -> list[tuple[str, str]]:
    """List a service's settings beside those that all have, each with the service."""
    common = {*ServiceSettings.model_fields, *SET_BY_UP}
    return [(service, name) for name in SETTINGS[service].model_fields if name not in common]


def _with_flags(command: Callable[..., None], settings: Iterable[tuple[str, str]]) -> Callable[..., None]:
    """Add to a command an option for each setting, named by service and name, that it lacks."""
    command_parameters = dict(inspect.signature(command, eval_str=True).parameters)
    del command_parameters["given"]  # the command gets this one from the flags below
    flags = {
        name: _flag(name, SETTINGS[service].model_fields[name], service)
        for service, name in settings
        if name not in command_parameters
    }

    @wraps(command)
    def with_given(**arguments: Any) -> None:
        given = {name: arguments.pop(name) for name in flags}
        command(**arguments, given={name: value for name, value in given.items() if value not in (None, [])})

    parameters = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in command_parameters.values()]
    with_given.__signature__ = inspect.Signature([*parameters, *flags.values()])  # type: ignore[attr-defined]
    return with_given


def _flag(name: str, field: FieldInfo, service: str) -> inspect.Parameter:
    """Return a setting's option for Typer; the service validates its value."""
    words: dict[str, Any] = {"help": explained(field), "rich_help_panel": f"Settings of {service}"}
    is_switch = not placeholder(field)
    if is_switch:
        annotation: Any = Annotated[bool | None, typer.Option(f"{flag_of(name)}/{negated_flag_of(name)}", **words)]
    else:
        annotation = Annotated[list[str] | None, typer.Option(flag_of(name), metavar=placeholder(field), **words)]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)
