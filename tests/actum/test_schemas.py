"""The JSON Schemas tell a reader what every field is."""

from collections.abc import Iterator
from typing import Any

import pytest

from actum.messages import MESSAGES, Message


def properties(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every field of a message and of its parts, by where it stands."""
    for part, content in {schema["title"]: schema, **schema.get("$defs", {})}.items():
        for name, described in content["properties"].items():
            yield f"{part}.{name}", described


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.SCHEMA)
def test_every_field_says_what_it_is(message: type[Message]) -> None:
    fields = dict(properties(message.model_json_schema(mode="validation")))

    assert {name for name, described in fields.items() if not described.get("description", "").endswith(".")} == set()
    assert any(name.endswith(".stamp_ns") for name in fields)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.SCHEMA)
def test_no_description_is_longer_than_a_paragraph(message: type[Message]) -> None:
    for name, described in properties(message.model_json_schema(mode="validation")):
        assert len(described["description"]) <= 320, name
