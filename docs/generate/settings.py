"""The services' settings, from the classes that declare them."""

from importlib import import_module
from pathlib import Path
from typing import Any

from docs.generate.markdown import code, table
from pydantic.fields import FieldInfo

from actum.command_line import LISTED, PAIRED, STRUCTURED, placeholder
from actum.settings import ServiceSettings

ROOT = Path(__file__).parents[2] / "services"
SERVICES = sorted(".".join(file.parent.relative_to(ROOT).parts) for file in ROOT.rglob("settings.py"))
UNITS = {
    "_mb": "MB",
    "_hours": "h",
    "_per_min": "1/min",
    "_ns": "ns",
    "_m": "m",
    "_deg": "°",
    "_s": "s",
    "_px": "px",
    "_hz": "Hz",
}
VALUES = {"INTEGER": "integer", "NUMBER": "number", "TEXT": "text", "PATH": "path"} | dict.fromkeys(
    (LISTED, PAIRED, STRUCTURED), "JSON"
)
OF_THIS_PROCESS = {
    "instance": "host, process id and four digits",
    "pose_model": "`~/.local/share/actum/` and its name",
    "trainer_data": "`~/.local/share/actum/teaching`",
}
"""Defaults that differ from machine to machine."""


def sections() -> str:
    """Write a table of what every service can be told, then one for each service."""
    parts = ["### Every service\n\n" + _table(ServiceSettings.model_fields)]
    for service in SERVICES:
        fields: dict[str, FieldInfo] = import_module(f"{service}.settings").Settings.model_fields
        own = {name: field for name, field in fields.items() if name not in ServiceSettings.model_fields}
        parts.append(f"### `{service}`\n\n{_table(own)}")
    return "\n".join(parts)


def _table(fields: dict[str, FieldInfo]) -> str:
    heads = ["flag", "environment", "value", "unit", "default", "what it is for"]
    return table(heads, ([*_named(name, field), field.description or ""] for name, field in fields.items()))


def _named(name: str, field: FieldInfo) -> list[str]:
    switch = not placeholder(field)
    kebab = name.replace("_", "-")
    flags = ", ".join(map(code, [f"--{kebab}", f"--no-{kebab}"] if switch else [f"--{kebab}"]))
    value = "1 or 0" if switch else VALUES.get(placeholder(field)) or placeholder(field).strip("{}").replace(",", ", ")
    unit = next((unit for suffix, unit in UNITS.items() if name.endswith(suffix)), "")
    return [flags, code(f"ACTUM_{name.upper()}"), value, unit, OF_THIS_PROCESS.get(name) or _default(field)]


def _default(field: FieldInfo) -> str:
    default: Any = field.get_default(call_default_factory=True)
    if default is None or default in ({}, [], "", frozenset()):
        return ""
    if isinstance(default, bool):
        return "on" if default else "off"
    if isinstance(default, frozenset):
        default = sorted(default)
    return code(default.as_posix() if isinstance(default, Path) else str(default).replace("'", '"'))
