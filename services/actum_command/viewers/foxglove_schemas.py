"""JSON Schemas of our messages in the subset that Foxglove reads.

Foxglove's reader (`parseJsonSchema` in its open sources) takes a plain type for each field: no `$ref`, no `anyOf`, no
object without `properties`. What may be null is declared as what it is otherwise; values are not checked against it.
"""

import json
from collections.abc import Mapping
from typing import Any

from actum import schemas
from actum.codec import schema_name
from actum.messages import Message

Schema = dict[str, Any]
"""A JSON Schema."""
KEPT = ("title", "description", "type")
"""What is taken over of each part as it is."""


def foxglove_schema(kind: type[Message]) -> Schema:
    """Return the schema of a kind of message, under the name that it has on the wire."""
    given = json.loads(schemas.committed(schemas.file_name(kind)))
    return {**_plain(given, given.get("$defs", {})), "title": schema_name(kind)}


def _plain(part: Schema, definitions: Mapping[str, Schema]) -> Schema:
    """Return a part with references put in, alternatives to null chosen, and without limits."""
    while "$ref" in part or "anyOf" in part:
        part = _meant(part, definitions)
    plain = {key: part[key] for key in KEPT if key in part}
    if part["type"] == "object":
        plain["properties"] = {name: _plain(field, definitions) for name, field in part.get("properties", {}).items()}
    elif part["type"] == "array":
        plain["items"] = _plain(part["items"], definitions)
    elif part.get("format") == "binary":
        plain["contentEncoding"] = "base64"
    return plain


def _meant(part: Schema, definitions: Mapping[str, Schema]) -> Schema:
    """Return what a part refers to, or which alternative to null it names, under the part's own title."""
    own = {key: value for key, value in part.items() if key not in ("$ref", "anyOf")}
    if "$ref" in part:
        return {**definitions[part["$ref"].rpartition("/")[2]], **own}
    [meant] = [alternative for alternative in part["anyOf"] if alternative.get("type") != "null"]
    return {**meant, **own}
