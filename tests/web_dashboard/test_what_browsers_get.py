"""What a browser gets of the messages, over a real WebSocket."""

import math
import socket
import time

import pytest

from actum.messages import Action, Skeleton, Tensor
from dashboards import Served, heard, served
from events import event
from node_cases import photograph
from people import STANDING, reaches, skeleton

STALL_S = 5.0


@pytest.fixture(scope="module")
def page() -> Served:
    with served() as made:
        yield made


def partial(stamp_ns: int, **fields: object) -> Action:
    return Action(
        stamp_ns=stamp_ns, sensor="kinect0", agent=1, segment_id="s", start_ns=0, end_ns=None, final=False,
        action="push", confidence=0.5, activations={}, part=None, frames=1, missed=0, **fields,
    )  # fmt: skip


def test_first_it_is_greeted(page: Served) -> None:
    with page.browser() as browser:
        hello = heard(browser, "hello")
    assert hello["sensor"] == "kinect0"
    assert hello["joints"][0] == "head"
    assert hello["connect"].startswith("tcp/")


def test_it_is_told_twice_a_second_whether_there_is_a_router(page: Served) -> None:
    with page.browser() as browser:
        assert heard(browser, "pulse")["router"] is True
        page.colleague.router = False
        while heard(browser, "pulse")["router"]:
            continue
    page.colleague.router = True


def test_it_gets_a_message_with_all_fields_and_its_type(page: Served) -> None:
    frame = reaches(1)[0]
    with page.browser() as browser:
        heard(browser, "hello")
        heard(browser, "pulse")
        page.give(frame)
        assert heard(browser, "skeleton") == {"type": "skeleton"} | frame.model_dump()


def test_numbers_that_json_lacks_come_as_null(page: Served) -> None:
    joints = [[math.nan, math.inf, 0.5]] + [None] * 14
    agent = reaches(1)[0].agents[0].model_copy(update={"joints": joints})
    with page.browser() as browser:
        heard(browser, "pulse")
        page.give(Skeleton(stamp_ns=1, sensor="kinect0", agents=[agent]))
        assert heard(browser, "skeleton")["agents"][0]["joints"][0] == [None, None, 0.5]


def test_an_image_comes_as_bytes_behind_its_fields(page: Served) -> None:
    image = photograph(stamp_ns=7)
    with page.browser() as browser:
        heard(browser, "pulse")
        page.give(image)
        got = heard(browser, "image/color")
    assert got.pop("data") == image.data
    assert got == {"type": "image/color"} | image.model_dump(exclude={"data"})


def test_maps_come_in_base64(page: Served) -> None:
    with page.browser() as browser:
        heard(browser, "pulse")
        page.give(partial(1, trace=Tensor(dtype="<f4", shape=[1, 1], data=b"\xff\xff\xff\xff")))
        assert heard(browser, "action")["trace"]["data"] == "_____w=="


def test_a_page_that_is_loaded_anew_gets_the_events_before(page: Served) -> None:
    page.give(event("before", "push the cup"))
    with page.browser() as browser:
        assert heard(browser, "event")["sentence"] == "push the cup"


def test_a_browser_that_reads_nothing_costs_the_others_no_frame(page: Served) -> None:
    """Also where what it does not read is more than all buffers between hold."""
    host, _, port = page.host.rpartition(":")
    image = photograph()
    large = image.model_copy(update={"data": image.data * 200})
    with page.browser() as reading, socket.create_connection((host, int(port))) as stalled:
        stalled.sendall(
            f"GET /ws HTTP/1.1\r\nHost: {page.host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
        )
        assert stalled.recv(12) == b"HTTP/1.1 101"
        heard(reading, "pulse")
        began_s = time.monotonic()
        for number in range(40):
            page.give(large.model_copy(update={"stamp_ns": number}), skeleton(number, STANDING))
            assert heard(reading, "skeleton")["stamp_ns"] == number
        assert time.monotonic() - began_s < STALL_S
