"""The JSON Schemas tell a reader what every field is, and the changelog tells their versions."""

import re
from collections.abc import Iterator
from itertools import dropwhile, takewhile
from pathlib import Path
from typing import Any

import pytest

from actum import schemas
from actum.messages import MESSAGES, Message

CHANGELOG = Path(__file__).parents[2] / "CHANGELOG.md"
ROW = re.compile(r"\| `([a-z_.]+)` \| (\d+) \|")


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


def newest_table() -> set[str]:
    """Read the schemas of the topmost table as the files are named, e.g. `actum.skeleton.1.json`."""
    lines = dropwhile(lambda line: line != "### Message schemas", CHANGELOG.read_text(encoding="utf-8").splitlines())
    section = takewhile(lambda line: not line.startswith("## "), lines)
    return {f"{row[1]}.{row[2]}.json" for row in map(ROW.fullmatch, section) if row}


def test_the_newest_table_names_every_schema_file_and_no_other() -> None:
    assert newest_table() == {file.name for file in Path(schemas.__file__).parent.glob("*.json")} != set()
