"""What browsers mark and ask: it is passed on, or refused with words, whatever it is."""

import json
from threading import Event
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed

from actum.commands import Refusal
from actum.messages import Segment
from actum.runtime.client import NotAnsweredError
from dashboards import Colleague, Served, answered, heard, served
from live import PATIENCE_S, wait_until
from web_dashboard.orders import LONGEST_ORDER_BYTES


def service(name: str, command: str, **fields: Any) -> dict[str, Any]:
    if name != "som_classifier":
        raise NotAnsweredError(f"{name} does not answer")
    if command == "refuse":
        raise Refusal("not now")
    return {"command": command, "fields": fields}


@pytest.fixture(scope="module")
def page() -> Served:
    with served(Colleague(service)) as made:
        yield made


def test_a_mark_is_put_as_one_by_hand(page: Served) -> None:
    with page.browser() as browser:
        for number, kind in enumerate(("start", "end")):
            mark = {"kind": kind, "segment_id": "page-1", "agent": 2}
            assert answered(browser, {"id": number, "mark": mark}) == {"id": number, "reply": {}}
    marks = page.colleague.put_messages[-2:]
    assert marks == [
        Segment(sensor="kinect0", kind=kind, segment_id="page-1", agent=2, origin="manual") for kind in ("start", "end")
    ]


def test_a_mark_that_nobody_listens_for_is_refused(page: Served) -> None:
    page.colleague.listened = False
    with page.browser() as browser:
        refused = answered(browser, {"id": 1, "mark": {"kind": "start", "segment_id": "a"}})
    page.colleague.listened = True
    assert "no service receives marks" in refused["error"]


def test_a_browser_that_goes_ends_the_segments_that_it_has_left_open_and_no_others() -> None:
    with served(Colleague(service)) as page, page.browser() as other:
        with page.browser() as browser:
            for number, name in enumerate(("left", "ended", "taken over")):
                assert "reply" in answered(browser, {"id": number, "mark": {"kind": "start", "segment_id": name}})
            assert "reply" in answered(browser, {"id": 3, "mark": {"kind": "end", "segment_id": "ended"}})
            assert "reply" in answered(other, {"id": 4, "mark": {"kind": "start", "segment_id": "other's"}})
            assert "reply" in answered(other, {"id": 5, "mark": {"kind": "end", "segment_id": "taken over"}})
        marks = page.colleague.put_messages
        wait_until(lambda: [mark.segment_id for mark in marks if mark.kind == "end"][2:] == ["left"], "it is ended", 5)


def test_a_segment_that_cannot_be_ended_is_counted() -> None:
    with served(Colleague(service)) as page:
        with page.browser() as browser:
            assert "reply" in answered(browser, {"id": 1, "mark": {"kind": "start", "segment_id": "left"}})
            page.colleague.router = False
        wait_until(lambda: page.rejects() == {"refused_browser": 1}, "it is counted", 5)


def test_only_what_a_service_itself_refuses_is_called_refused(page: Served) -> None:
    with page.browser() as browser:
        for name, command, refused in (("som_classifier", "refuse", True), ("model_trainer", "list", False)):
            answer = answered(browser, {"id": 1, "ask": {"service": name, "command": command}})
            assert answer["refused"] is refused


def test_a_command_is_answered_by_its_service(page: Served) -> None:
    with page.browser() as browser:
        ask = {"service": "som_classifier", "command": "maps", "fields": {"a": [1, None]}}
        reply = {"command": "maps", "fields": {"a": [1, None]}}
        assert answered(browser, {"id": 5, "ask": ask}) == {"id": 5, "reply": reply}


@pytest.mark.parametrize(
    ("ask", "error"),
    [
        ({"service": "som_classifier", "command": "refuse"}, "not now"),
        ({"service": "model_trainer", "command": "list"}, "model_trainer does not answer"),
        ({"service": "../..", "command": "list"}, "ask.service"),
        ({"service": "som_classifier", "command": "**"}, "ask.command"),
        (
            {"service": "som_classifier", "command": "maps", "fields": {"timeout_s": 1e9}},
            "a command cannot have the fields timeout_s, because",
        ),
        (
            {"service": "som_classifier", "command": "maps", "fields": {"self": 1}},
            "a command cannot have the fields self, because",
        ),
        ({"service": "som_classifier"}, "ask.command is missing"),
    ],
)
def test_a_command_that_is_wrong_is_refused_with_words(page: Served, ask: dict[str, Any], error: str) -> None:
    with page.browser() as browser:
        answer = answered(browser, {"id": 1, "ask": ask})
    assert answer["id"] == 1
    assert error in answer["error"]


def test_without_a_router_it_says_so(page: Served) -> None:
    page.colleague.router = False
    with page.browser() as browser:
        assert (
            "not connected to a router"
            in answered(browser, {"id": 1, "ask": {"service": "a", "command": "b"}})["error"]
        )
    page.colleague.router = True


@given(
    order=st.one_of(
        st.text(), st.recursive(st.none() | st.booleans() | st.integers() | st.text(), st.lists).map(json.dumps)
    )
)
def test_anything_else_is_answered_with_an_error_and_counted(page: Served, order: str) -> None:
    before = page.rejects().get("refused_browser", 0)
    with page.browser() as browser:
        assert answered(browser, order)["error"]
        assert page.node.working
    assert page.rejects()["refused_browser"] == before + 1


def test_more_orders_than_can_wait_end_the_connection() -> None:
    answered = Event()
    with served(Colleague(lambda *_, **__: {"came": answered.wait(PATIENCE_S)})) as page:
        with page.browser() as browser, pytest.raises(ConnectionClosed):
            for number in range(10_000):
                browser.send(json.dumps({"id": number, "ask": {"service": "som_classifier", "command": "maps"}}))
        answered.set()
        assert page.node.working


def test_a_name_of_ten_megabytes_ends_that_connection_and_no_other(page: Served) -> None:
    with page.browser() as other, page.browser() as browser:
        mark = {"kind": "start", "segment_id": "a" * 10_000_000}
        with pytest.raises(ConnectionClosed) as closed:
            answered(browser, {"id": 1, "mark": mark})
        assert closed.value.rcvd is None or closed.value.rcvd.code == 1009
        heard(other, "pulse")
        short = answered(other, {"id": 1, "mark": mark | {"segment_id": "a" * (LONGEST_ORDER_BYTES // 2)}})
        assert "at most 200 characters" in short["error"]
