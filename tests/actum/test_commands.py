"""Commands: fields in, fields out, refusals in words; and settings that may be changed while a service runs."""

import math
from typing import Annotated, Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field

from actum.codec import encode
from actum.commands import JSON, MAX_REQUEST_BYTES, MSGPACK, Command, Refusal, Request, described, packed, unpacked
from actum.node import Counters
from actum.parameters import LiveParameters
from actum.runtime.reporting import Meter
from actum.settings import ServiceSettings


class Greet(Request):
    name: str = Field(max_length=5)


class Greeting(BaseModel):
    text: str


def greet(request: Greet) -> Greeting:
    """Greet somebody.

    Nobody else is greeted.
    """
    if request.name == "me":
        raise Refusal("greet somebody else")
    return Greeting(text=f"hello {request.name}")


GREET = Command("greet", Greet, Greeting, greet)
NO_ENCODING_HOLDS = (
    math.inf, math.nan, 2**70, -(2**63) - 1, "\ud800", {"\ud800": 1}, {1: 2}, (1,), msgpack.ExtType(1, b""),
)  # fmt: skip
"""Values that one of the encodings cannot hold: they reach no handler, whose reply may repeat them."""


def test_a_command_answers_its_reply_s_fields() -> None:
    assert GREET.obey({"name": "you"}) == {"text": "hello you"}


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({}, "^name is missing$"),
        ({"name": "somebody"}, "^name should have at most 5 characters$"),
        ({"name": "you", "loud": True}, "there is no field loud"),
        ({"name": "me"}, "greet somebody else"),
        *(({"name": value}, "the request") for value in NO_ENCODING_HOLDS),
    ],
)
def test_what_it_cannot_do_it_refuses_in_words(fields: dict[str, Any], why: str) -> None:
    with pytest.raises(Refusal, match=why):
        GREET.obey(fields)


def test_the_list_of_commands_describes_each_by_the_first_line_and_schemas() -> None:
    later = Command("adieu", Greet, Greeting, greet)
    first, second = described([GREET, later]).commands
    assert (first.name, second.name) == ("adieu", "greet")
    assert second.description == "Greet somebody."
    assert second.request["properties"]["name"]["maxLength"] == 5
    assert second.reply["properties"]["text"]["type"] == "string"


@given(
    st.dictionaries(
        st.text(),
        st.recursive(st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.text(), st.lists, max_leaves=10),
    )
)
def test_fields_are_read_as_they_were_written_in_either_encoding(fields: dict[str, Any]) -> None:
    for encoding in (JSON, MSGPACK):
        assert unpacked(packed(fields, encoding), encoding) == fields


def test_without_payload_there_are_no_fields() -> None:
    assert unpacked(b"", "") == {}


@pytest.mark.parametrize(
    ("payload", "encoding"),
    [
        (b"[1]", JSON),
        (b"{", JSON),
        (b"\xff\xfe", JSON),
        (b"[" * 100_000, JSON),
        (msgpack.packb([1]), MSGPACK),
        (msgpack.packb({1: 2}), MSGPACK),
        (b"\xc1", MSGPACK),
        (b" " * (MAX_REQUEST_BYTES + 1), JSON),
    ],
)
def test_what_is_no_object_is_refused(payload: bytes, encoding: str) -> None:
    with pytest.raises(Refusal, match="the request"):
        unpacked(payload, encoding)


@pytest.mark.parametrize(
    ("value", "encoding"),
    [(value, encoding) for value in ("\ud800", object(), {"deep": {1, 2}}) for encoding in (JSON, MSGPACK)]
    + [(2**70, MSGPACK), (math.nan, JSON)],
)
def test_fields_that_cannot_be_encoded_are_refused(value: Any, encoding: str) -> None:
    with pytest.raises(Refusal, match=f"the value of a field cannot be encoded as {encoding}"):
        packed({"name": value}, encoding)


def test_a_refusal_and_the_newest_error_can_be_encoded_whatever_text_they_quote() -> None:
    assert str(Refusal("no set \ud800 é")) == "no set \\ud800 é"
    counters = Counters()
    counters.reject("bad_model", "models/\udcff.npz" * 200)
    assert counters.last_error is not None and counters.last_error.startswith("bad_model: models/\\udcff.npz")


def test_a_status_and_a_description_can_be_encoded_whatever_the_state_and_the_model_are_called() -> None:
    counters = Counters(state="no model: there is no \udcff.npz yet", details={"model": "\udcff", "source": "\ud800"})
    meter = Meter("som_classifier", counters, ServiceSettings())
    assert encode(meter.status()) and encode(meter.info())


def test_a_refusal_names_some_of_many_problems() -> None:
    with pytest.raises(Refusal) as refused:
        GREET.obey({f"field {n}": n for n in range(1000)})
    assert str(refused.value).endswith("and 996 more") and len(str(refused.value)) < 500


class Adjustable(ServiceSettings):
    reach_m: float = Field(0.5, gt=0, le=2, description="how far")
    rate_hz: Annotated[int | None, Field(ge=1)] = Field(None, description="how often")
    fixed: bool = False


@pytest.fixture
def applied() -> list[Adjustable]:
    return []


@pytest.fixture
def parameters(applied: list[Adjustable]) -> dict[str, Command[Any, Any]]:
    live = LiveParameters(Adjustable.model_construct(), ("reach_m", "rate_hz"), applied.append)
    return {command.name: command for command in live.commands}


def test_parameters_have_range_and_unit(parameters: dict[str, Command[Any, Any]]) -> None:
    reach, rate = parameters["parameters"].obey({})["parameters"]
    assert (reach["value"], reach["above"], reach["maximum"], reach["unit"]) == (0.5, 0.0, 2.0, "m")
    assert (rate["value"], rate["minimum"], rate["unit"]) == (None, 1.0, "Hz")
    assert (rate["type"], rate["optional"]) == ("integer", True)


def test_new_values_are_applied_and_listed(parameters: dict[str, Command[Any, Any]], applied: list[Adjustable]) -> None:
    listed = parameters["set_parameters"].obey({"values": {"reach_m": 1, "rate_hz": 5}})
    assert [each["value"] for each in listed["parameters"]] == [1.0, 5]
    assert [(each.reach_m, each.rate_hz) for each in applied] == [(1.0, 5)]


@pytest.mark.parametrize(
    "values", [{"reach_m": 3}, {"reach_m": math.nan}, {"rate_hz": 2, "reach_m": -1}, {"fixed": True}, {"reach": 1}, {}]
)
def test_a_refused_value_changes_nothing(
    parameters: dict[str, Command[Any, Any]], applied: list[Adjustable], values: dict[str, Any]
) -> None:
    before = parameters["parameters"].obey({})
    with pytest.raises(Refusal):
        parameters["set_parameters"].obey({"values": values})
    assert not applied and parameters["parameters"].obey({}) == before
