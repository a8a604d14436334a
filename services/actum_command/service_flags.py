"""The settings of the services as flags of a command that starts them, from where the services declare them."""

import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Annotated, Any

import typer
from pydantic.fields import FieldInfo

import action_fusion.settings
import marker_tracker.settings
import pose_preprocessor.settings
import scene_simulator.settings
import sensor_gateway.settings
import som_classifier.settings
from actum.command_line import explained, placeholder
from actum.settings import ServiceSettings

DECLARED: Mapping[str, type[ServiceSettings]] = {
    service.__name__: service.settings.Settings
    for service in (sensor_gateway, scene_simulator, pose_preprocessor, som_classifier, marker_tracker, action_fusion)
}
"""What each service can be told."""

Given = Mapping[str, bool | list[str]]
"""The settings that stood on the command line, by name."""


def with_service_flags(command: Callable[..., None]) -> Callable[..., None]:
    """Let a command take every setting of the services that it has no flag for itself; it gets them as `given`."""
    own = dict(inspect.signature(command, eval_str=True).parameters)
    del own["given"]
    flags = {name: _flag(name, field, service) for service, name, field in _settings() if name not in own}

    @wraps(command)
    def with_given(**arguments: Any) -> None:
        given = {name: arguments.pop(name) for name in flags}
        command(**arguments, given={name: value for name, value in given.items() if value not in (None, [])})

    parameters = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in own.values()]
    with_given.__signature__ = inspect.Signature([*parameters, *flags.values()])  # type: ignore[attr-defined]
    return with_given


def arguments_of(service: str, given: Given) -> list[str]:
    """Write those of the given settings that a service has as its flags."""
    arguments: list[str] = []
    for name, value in given.items():
        if name not in DECLARED[service].model_fields:
            continue
        if isinstance(value, bool):
            arguments.append(flag_of(name) if value else f"--no-{_kebab(name)}")
        else:
            arguments += [f"{flag_of(name)}={text}" for text in value]
    return arguments


def flag_of(name: str) -> str:
    """Write a setting's name as a flag."""
    return f"--{_kebab(name)}"


def _kebab(name: str) -> str:
    return name.replace("_", "-")


def _settings() -> list[tuple[str, str, FieldInfo]]:
    """List the settings of each service beside what every service can be told."""
    return [
        (service, name, field)
        for service, settings in DECLARED.items()
        for name, field in settings.model_fields.items()
        if name not in ServiceSettings.model_fields
    ]


def _flag(name: str, field: FieldInfo, service: str) -> inspect.Parameter:
    """Declare a flag for Typer; its value is the service's to judge."""
    words: dict[str, Any] = {"help": explained(field), "rich_help_panel": f"Settings of {service}"}
    is_switch = not placeholder(field)
    if is_switch:
        annotation: Any = Annotated[bool | None, typer.Option(f"{flag_of(name)}/--no-{_kebab(name)}", **words)]
    else:
        annotation = Annotated[list[str] | None, typer.Option(flag_of(name), metavar=placeholder(field), **words)]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)
