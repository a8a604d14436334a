"""The messages field by field, from the models' own JSON Schemas: type, unit, an example, what it means."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from docs.generate.markdown import code, table

from actum import keys
from actum.codec import schema_name
from actum.messages import MESSAGES, Message

EXAMPLES = Path(__file__).with_name("examples.json")
"""Messages of a run of the simulated scene; the later ones of a schema fill what the first leaves null."""

SUFFIXES = {"_ns": "ns", "_m": "m", "_mps": "m/s", "_deg": "°", "_ms": "ms", "_s": "s"}
"""Units that a field's name ends in."""

UNITS = {
    "seq": "count", "agent": "id", "agents": "id", "id": "id", "object_id": "id",
    "objects_present": "id", "frames": "count", "missed": "count", "handled": "count", "drops": "count",
    "rejects": "count", "counts": "count", "count": "count", "rates": "Hz", "rate_hz": "Hz", "confidence": "0 to 1",
    "activations": "−1 to 1", "familiarity": "0 to 1", "completeness": "0 to 1",
    "probability": "0 to 1", "soon_probability": "0 to 1", "action_probability": "0 to 1",
    "quaternion_xyzw": "1", "up_in_camera": "any length", "width": "px", "height": "px", "K": "px", "distortion": "1",
    "skeleton_from_image": "m", "ego_from_camera": "m", "joints": "m", "upright": "m", "motion": "m", "shape": "count",
    "asked": "count", "counted": "count", "seconds": "s", "people": "count", "done": "0 to 1", "revision": "count",
}  # fmt: skip
"""Units of the other fields that hold numbers. In transforms the rotation has none."""

TYPES = {"": "map", "string": "text", "boolean": "true or false"}
PLURAL = ("integer", "number", "text", "map")
SHOWN = (
    *("segment_id", "start_ns", "end_ns", "agent", "action", "confidence", "unknown"),
    *("object", "hand", "motion", "result", "outcome", "sentence", "valid", "reason"),
)
"""Fields of an event that the README shows."""

LONGEST_EXAMPLE = 44
LONGEST_LINE = 110


class UnknownUnitError(KeyError):
    """A field holds numbers, and neither its name nor the table says in which unit."""


@dataclass(frozen=True)
class Field:
    """One field of a message: its path, such as `agents[].joints`, its JSON Schema, and values it had.

    `like` is the path of the field with the same parts that came before it; they are not listed again.
    """

    path: str
    schema: dict[str, Any]
    values: tuple[Any, ...]
    like: str = ""

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2].removesuffix("[]")


def sections() -> str:
    """Write the part of the page: what all messages have, then a section for each."""
    header = [field for field in fields_of(keys.COLOR.message) if _is_common(field)]
    sections = ["### Every message\n\n" + _table(header)]
    return "\n".join(sections + [section(message) for message in MESSAGES])


def fields_of(message: type[Message]) -> list[Field]:
    """List a message's fields, parts of parts included, in the order of their declaration."""
    schema = message.model_json_schema(mode="validation")
    return list(_walk("", schema, schema.get("$defs", {}), tuple(examples()[schema_name(message)]), {}))


@cache
def examples() -> dict[str, list[dict[str, Any]]]:
    """Read the example messages by schema."""
    read: dict[str, list[dict[str, Any]]] = json.loads(EXAMPLES.read_text(encoding="utf-8"))
    return read


def unit(field: Field) -> str:
    """Name the unit of what a field holds; "" where it holds no numbers.

    Raises:
        UnknownUnitError: neither the field's name nor the table tells.
    """
    if not has_numbers(field.schema):
        return ""
    for suffix, name in SUFFIXES.items():
        if field.name.endswith(suffix):
            return name
    if field.name not in UNITS:
        raise UnknownUnitError(f"{field.path}: name its unit in UNITS")
    return UNITS[field.name]


def example(field: Field) -> str:
    """Write the first value that says something, cut to a line."""
    telling = [value for value in field.values if value not in (None, [], {}, "")]
    if not telling:
        return "null" if None in field.values else json.dumps(next(iter(field.values), ""))
    text = _short(telling[0])
    return text if len(text) <= LONGEST_EXAMPLE else text[: LONGEST_EXAMPLE - 1].rstrip(" ,") + "…"


def section(message: type[Message]) -> str:
    """Write the section of one message: its key, its own fields, an example."""
    on = " and ".join(
        f"`{keys.BASE}/<sensor>/{topic.leaf.format('<service>' if 'service' in message.model_fields else '<agent>')}`"
        for topic in keys.TOPICS
        if topic.message is message
    )
    own = [field for field in fields_of(message) if not _is_common(field)]
    first = _laid_out(_elided(examples()[schema_name(message)][0]))
    return f"### `{schema_name(message)}`\n\n{_sentence(message)} On {on}.\n\n{_table(own)}\n```json\n{first}\n```\n"


def shown_event() -> str:
    """Write one event of a run, without what most readers do not need."""
    event = examples()["actum.event/1"][0]
    return f"```json\n{_laid_out({name: event[name] for name in SHOWN})}\n```\n"


def _is_common(field: Field) -> bool:
    """Tell whether all messages have the field, and mean the same by it."""
    common = Message.model_fields.get(field.path)
    return common is not None and _meaning(field) == " ".join((common.description or "").split())


def _sentence(message: type[Message]) -> str:
    return (message.__doc__ or "").strip().splitlines()[0]


def _table(fields: list[Field]) -> str:
    rows = ([code(f.path), typed(f.schema), unit(f), code(example(f)), _meaning(f)] for f in fields)
    return table(["field", "type", "unit", "example", "meaning"], rows)


def _meaning(field: Field) -> str:
    parts = f" Its parts are those of `{field.like}`." if field.like else ""
    return " ".join(field.schema.get("description", "").split()) + parts


def typed(schema: dict[str, Any]) -> str:
    """Say in words what a JSON Schema admits."""
    kind = schema.get("type", "")
    if "anyOf" in schema or "enum" in schema:
        return " or ".join([*map(typed, schema.get("anyOf", [])), *map(_value, schema.get("enum", []))])
    if "const" in schema:
        return _value(schema["const"])
    if kind == "array":
        return _listed(schema)
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"map from text to {typed(schema['additionalProperties'])}"
    return "bytes" if schema.get("format") == "binary" else TYPES.get(kind, kind)


def _listed(schema: dict[str, Any]) -> str:
    each = typed(schema["items"])
    if schema.get("minItems") == schema.get("maxItems", -1):
        return f"{schema['minItems']} {each}s" if each in PLURAL else f"{schema['minItems']} × ({each})"
    return f"list of {each}s" if each in PLURAL else f"list of {each}"


def _value(value: Any) -> str:
    return code(json.dumps(value))


def _walk(
    prefix: str, schema: dict[str, Any], parts: dict[str, Any], messages: tuple[Any, ...], seen: dict[str, str]
) -> Iterator[Field]:
    for name, own in schema["properties"].items():
        path = f"{prefix}{name}"
        held = tuple(message[name] for message in messages if isinstance(message, dict) and name in message)
        part, mark = _part(own)
        yield Field(path, own, held, seen.get(part, ""))
        if part in parts and part not in seen:
            seen[part] = path + mark
            inner = [value for value in held if value is not None]
            if mark:
                inner = [each for value in inner for each in (value.values() if isinstance(value, dict) else value)]
            yield from _walk(f"{path}{mark}.", parts[part], parts, tuple(inner), seen)


def _part(schema: dict[str, Any]) -> tuple[str, str]:
    """Find the part that a field is, or is a list or map of: its name, and the mark behind the field's."""
    options = [schema, *schema.get("anyOf", []), *schema.get("allOf", [])]
    for option in options:
        for inner, mark in ((option, ""), (option.get("items"), "[]"), (option.get("additionalProperties"), "[]")):
            if isinstance(inner, dict) and "$ref" in inner:
                return inner["$ref"].rpartition("/")[2], mark
    return "", ""


def has_numbers(schema: dict[str, Any]) -> bool:
    """Tell whether a JSON Schema admits numbers, alone or in a list."""
    inner = [schema.get("items"), schema.get("additionalProperties"), *schema.get("anyOf", [])]
    return schema.get("type") in ("integer", "number") or any(has_numbers(it) for it in inner if isinstance(it, dict))


def _short(value: Any) -> str:
    return json.dumps(_elided(value), ensure_ascii=False).replace('"…"', "…")


def _elided(value: Any) -> Any:
    """Leave out the rest of long lists."""
    if isinstance(value, dict):
        return {name: _elided(inner) for name, inner in value.items()}
    if isinstance(value, list):
        most = 3 if value and not isinstance(value[0], int | float) else 16
        return [_elided(inner) for inner in value[:most]] + ["…"] * (len(value) > most)
    return value


def _laid_out(value: Any, indent: int = 0) -> str:
    """Write JSON with what is short, and lists of plain values, on one line."""
    flat = json.dumps(value, ensure_ascii=False)
    plain = isinstance(value, list) and not any(isinstance(inner, list | dict) for inner in value)
    if plain or (indent and len(flat) <= LONGEST_LINE - indent):
        return flat
    margin = " " * indent
    named = [f"{json.dumps(name)}: " for name in value] if isinstance(value, dict) else [""] * len(value)
    inner = value.values() if isinstance(value, dict) else value
    lines = [f"{margin}  {name}{_laid_out(each, indent + 2)}" for name, each in zip(named, inner, strict=True)]
    first, last = ("{", "}") if isinstance(value, dict) else ("[", "]")
    return "\n".join([first, ",\n".join(lines), f"{margin}{last}"])
