"""A service's settings as flags, with help in plain words in place of Python's types and values."""

import types
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic.fields import FieldInfo
from pydantic_settings import CliSettingsSource, NoDecode

from actum.settings import ServiceSettings

S = TypeVar("S", bound=ServiceSettings)

PLACEHOLDERS: dict[Any, str] = {bool: "", int: "INTEGER", float: "NUMBER", str: "TEXT", Path: "PATH"}
"""The placeholder after a flag in the help, by the type of its value."""
LISTED, PAIRED, STRUCTURED = "VALUE,…", "NAME=VALUE,…", "JSON"
"""The placeholders of lists, of maps from text to text, and of other maps. Flags accept JSON for all three."""


def from_command_line(settings_type: type[S], program: str, arguments: Sequence[str] | None = None) -> S:
    """Read settings from this process's flags or given ones, then from the environment and the configuration file.

    Raises:
        ValueError: they cannot be used.
    """
    source = CliSettingsSource[Any](settings_type, cli_prog_name=program)
    for action in source.root_parser._actions:
        field = settings_type.model_fields.get(action.dest)
        if field is not None:
            action.metavar = placeholder(field) or None
            action.help = explained(field).replace("%", "%%")
    return settings_type(_cli_settings_source=source(args=True if arguments is None else list(arguments)))


def explained(field: FieldInfo) -> str:
    """Return a setting's help: its description, and its default where there is one."""
    default = field.get_default(call_default_factory=True)
    if default is None or default in ({}, [], "", frozenset()):
        return field.description or ""
    return f"{field.description} (default: {_worded(default)})"


def placeholder(field: FieldInfo) -> str:
    """Return the placeholder after a setting's flag; "" for a switch."""
    if NoDecode in field.metadata:
        return PLACEHOLDERS[str]
    annotation: Any = field.annotation
    if get_origin(annotation) in (Union, types.UnionType):  # X | None: the placeholder is that of X
        (annotation,) = (part for part in get_args(annotation) if part is not type(None))
    if get_origin(annotation) is Literal:
        return f"{{{','.join(map(str, get_args(annotation)))}}}"
    if annotation in PLACEHOLDERS:
        return PLACEHOLDERS[annotation]
    container = get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
    if get_origin(container) is not dict:
        return LISTED
    return PAIRED if container == dict[str, str] else STRUCTURED


def _worded(default: Any) -> str:
    """Return a default value as the help shows it."""
    match default:
        case bool():
            return "on" if default else "off"
        case frozenset():
            return ",".join(sorted(default))
        case dict():
            return ",".join(f"{name}={value}" for name, value in default.items())
        case _:
            return str(default)
