"""What the pages show of the code is what the code is: every field, setting, reject and reason, with an explanation."""

import json
from importlib import import_module
from pathlib import Path

import pytest
from docs.generate import fields, settings
from docs.generate.pages import PAGES, renewed
from docs.generate.process_diagram import DIAGRAM, diagram
from docs.generate.reasons import REASONS
from docs.generate.rejects import COUNTED_BY, REJECTS

from actum.codec import schema_name
from actum.messages import MESSAGES, Message
from actum.settings import ServiceSettings
from collected_texts import reasons, reject_kinds

DOCS = Path(__file__).parents[2] / "docs"
MESSAGES_PAGE = (DOCS / "messages.md").read_text(encoding="utf-8")
SETTINGS_PAGE = (DOCS / "settings.md").read_text(encoding="utf-8")
every_message = pytest.mark.parametrize("message", MESSAGES, ids=schema_name)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_is_as_make_pages_writes_it(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert renewed(text) == text


def test_the_diagram_is_as_make_pages_writes_it() -> None:
    assert DIAGRAM.read_text(encoding="utf-8") == diagram()


@every_message
def test_every_field_of_a_message_has_a_line(message: type[Message]) -> None:
    section = MESSAGES_PAGE.partition(f"### `{schema_name(message)}`")[2].partition("\n### ")[0]
    for name in message.model_fields:
        assert f"| `{name}` |" in (MESSAGES_PAGE if name in Message.model_fields else section)


@every_message
def test_every_field_has_a_meaning_and_where_it_holds_numbers_a_unit(message: type[Message]) -> None:
    for field in fields.fields_of(message):
        assert field.schema.get("description"), field.path
        assert bool(fields.unit(field)) == fields.has_numbers(field.schema), field.path


@every_message
def test_every_field_has_an_example_that_says_something(message: type[Message]) -> None:
    lines = (line for line in fields.section(message).splitlines() if line.startswith("| `"))
    assert [line for line in lines if line.split(" | ")[3] in ("`null`", "`[]`", "`{}`", '`""`')] == []


@every_message
def test_the_examples_are_messages(message: type[Message]) -> None:
    for example in fields.examples()[schema_name(message)]:
        message.model_validate_json(json.dumps(example))


def test_every_kind_that_is_rejected_is_explained_and_none_else() -> None:
    assert set(REJECTS) == set(reject_kinds().texts)


def test_no_kind_escapes_the_search() -> None:
    found = reject_kinds()
    assert len(found.texts) > 30
    assert found.unknown == {}


OTHER_NAMES = {"command": "event_recorder"}
"""The services that are not called as the package that they are in."""


DECODING = "shared/actum/images.py"
"""Errors of this module have a kind, by which the tracker alone counts them."""


def service_of(place: str) -> str:
    package = place.split("/")[1].removeprefix("actum_")
    return "marker_tracker" if place.startswith(DECODING) else OTHER_NAMES.get(package, package)


def test_the_page_names_the_services_that_count_a_kind() -> None:
    for kind, places in reject_kinds().texts.items():
        services = {service_of(place) for place in places}
        assert services == (set(REJECTS[kind]) or {"actum"}), kind


def test_every_reason_is_explained_and_none_else() -> None:
    assert set(REASONS) == set(reasons().texts)


def test_every_explanation_says_what_to_do() -> None:
    for kinds in (*(kinds for _, kinds in COUNTED_BY), REASONS):
        for text, problem in kinds.items():
            assert problem.meaning.endswith("."), text
            assert problem.remedy.endswith((".", "?")), text


def test_every_setting_of_every_service_has_a_line() -> None:
    for service in settings.SERVICES:
        section = SETTINGS_PAGE.partition(f"### `{service}`")[2].partition("\n### ")[0]
        for name in import_module(f"{service}.settings").Settings.model_fields:
            told = SETTINGS_PAGE if name in ServiceSettings.model_fields else section
            assert f"`ACTUM_{name.upper()}`" in told, name
