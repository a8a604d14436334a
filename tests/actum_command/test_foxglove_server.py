"""Who may open the stream for Foxglove: programs of this machine, and pages of named sites; by real handshakes."""

import http.client
import json
import re
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from threading import Event as Flag
from typing import Any

import pytest

from empty_messages import image, skeleton
from live import PATIENCE_S, wait_until

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: pip install -e '.[dev]'")
from typer.testing import CliRunner
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from actum_command.__main__ import app
from actum_command.viewers.foxglove_sinks import FoxgloveStream, served

SUBPROTOCOL = "foxglove.sdk.v1"
APP = "https://app.foxglove.dev"
SKELETONS = "/actum/kinect0/skeleton"


@dataclass
class Serving:
    """A stream that is served on a free port."""

    stream: FoxgloveStream
    address: str
    subscribed: Flag
    refused: list[str] = field(default_factory=list)

    @property
    def port(self) -> int:
        return int(self.address.rpartition(":")[2])

    @contextmanager
    def opened(self, host: str = "127.0.0.1", **options: Any) -> Iterator[ClientConnection]:
        """Shake hands with this machine, under the name that stands in the request."""
        plain = socket.create_connection(("127.0.0.1", self.port))
        options = {"subprotocols": [SUBPROTOCOL], "max_size": None, **options}
        with plain, connect(f"ws://{host}:{self.port}/", sock=plain, **options) as client:
            yield client


@contextmanager
def serving(*origins: str, host: str = "127.0.0.1") -> Iterator[Serving]:
    refused: list[str] = []
    subscribed = Flag()
    with served(["kinect0"], host, 0, subscribed, origins, refused.append) as (stream, address):
        yield Serving(stream, address, subscribed, refused)


@pytest.fixture(scope="module")
def usual() -> Iterator[Serving]:
    with serving() as made:
        yield made


def advertised(client: ClientConnection) -> dict[str, dict[str, Any]]:
    """Read until the topics are named."""
    while True:
        told = json.loads(client.recv(timeout=PATIENCE_S))
        if told["op"] == "advertise":
            return {channel["topic"]: channel for channel in told["channels"]}


def messages(client: ClientConnection, count: int, patience_s: float = PATIENCE_S) -> list[tuple[int, int, bytes]]:
    head = struct.Struct("<BIQ")
    received = [client.recv(timeout=patience_s) for _ in range(count)]
    assert all(isinstance(each, bytes) and each[0] == 1 for each in received)
    return [(*head.unpack_from(each)[1:], each[head.size :]) for each in received]  # type: ignore[arg-type]


def subscribe(client: ClientConnection, channel: int, subscription: int) -> None:
    asked = {"op": "subscribe", "subscriptions": [{"id": subscription, "channelId": channel}]}
    client.send(json.dumps(asked))


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "https://evil.example", APP, "null", "file://", "http://127.0.0.1:1", "http://localhost"],
)
def test_a_page_of_another_site_does_not_get_in(usual: Serving, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused, usual.opened(origin=origin):
        pass
    assert refused.value.response.status_code == 403
    assert repr(origin) in usual.refused[-1]
    assert "--origin" in usual.refused[-1]


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "192.0.2.1"])
@pytest.mark.parametrize("with_origin", [False, True])
def test_nor_does_one_whose_name_was_made_to_point_here(usual: Serving, host: str, with_origin: bool) -> None:
    origin = f"http://{host}:{usual.port}" if with_origin else None
    with pytest.raises(InvalidStatus) as refused, usual.opened(host, origin=origin):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "[::1]"])
def test_a_program_of_this_machine_gets_in(usual: Serving, host: str) -> None:
    with usual.opened(host) as client:
        assert client.subprotocol == SUBPROTOCOL
        assert {"/tf", SKELETONS, "/actum/kinect0/event"} <= advertised(client).keys()


def test_a_site_that_was_named_gets_in_and_no_other() -> None:
    with serving(APP) as made:
        with made.opened(origin=APP) as client:
            assert advertised(client)
        for other in (f"{APP}.evil.example", "http://app.foxglove.dev", f"{APP}:8443"):
            with pytest.raises(InvalidStatus), made.opened(origin=other):
                pass


def test_nothing_but_the_stream_is_served_and_nothing_to_scripts_of_other_sites(usual: Serving) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", usual.port, timeout=PATIENCE_S)
    connection.request("GET", "/", headers={"Origin": "http://evil.example"})
    answer = connection.getresponse()
    assert answer.status == 404
    assert "access-control-allow-origin" not in answer.headers
    connection.close()


def test_who_subscribes_gets_each_message_of_the_topic_until_they_do_no_more(usual: Serving) -> None:
    with usual.opened() as client:
        channel = advertised(client)[SKELETONS]
        assert (channel["encoding"], channel["schemaName"]) == ("protobuf", "foxglove.SceneUpdate")
        subscribe(client, channel["id"], 7)
        assert usual.subscribed.wait(PATIENCE_S)
        for stamp_ns in (1, 2):
            usual.stream.show(skeleton(stamp_ns))
        assert [(each, stamp_ns) for each, stamp_ns, _ in messages(client, 2)] == [(7, 1), (7, 2)]
        client.send(json.dumps({"op": "unsubscribe", "subscriptionIds": [7]}))
        subscribe(client, channel["id"], 8)
        taken: list[int] = []

        def by_the_second() -> bool:
            usual.stream.show(skeleton(3))
            with suppress(TimeoutError):  # between the two subscriptions a message goes to nobody
                taken.append(messages(client, 1, patience_s=0.1)[0][0])
            return taken[-1:] == [8]

        wait_until(by_the_second, "the second subscription is served")
        assert {*taken[taken.index(8) :]} == {8}


@pytest.mark.parametrize(
    "sent",
    ["", "no JSON", "[]", "{}", '{"op": "subscribe"}', '{"op": "subscribe", "subscriptions": [{"id": "x"}]}', b"\x00"],
)
def test_who_speaks_otherwise_disturbs_nobody(usual: Serving, sent: str | bytes) -> None:
    with usual.opened() as client, usual.opened() as other:
        advertised(client)
        client.send(sent)
        channel = advertised(other)[SKELETONS]
        subscribe(other, channel["id"], 1)
        seen: list[object] = []

        def is_served() -> bool:
            usual.stream.show(skeleton(4))
            try:
                seen.append(other.recv(timeout=0.1))
            except TimeoutError:
                return False
            return True

        wait_until(is_served, "the other client is served")


def test_who_takes_nothing_costs_bounded_memory_and_it_is_told(caplog: pytest.LogCaptureFixture) -> None:
    with serving() as made, made.opened(max_queue=1, close_timeout=0.1) as client:
        subscribe(client, advertised(client)["/actum/kinect0/image/color"]["id"], 1)
        assert made.subscribed.wait(PATIENCE_S)
        picture = image(1).model_copy(update={"data": bytes(4_000_000)})
        for _ in range(60):
            made.stream.show(picture)
    assert re.search(r"\d+ messages were dropped", caplog.text)


def test_who_speaks_no_such_protocol_is_refused(usual: Serving) -> None:
    with pytest.raises(InvalidStatus), usual.opened(subprotocols=None):
        pass


@pytest.mark.parametrize(
    "origin", ["*", "null", "app.foxglove.dev", "https://", "https://a/b", "javascript:1", "file://a", "", "http://["]
)
def test_an_origin_that_names_no_site_is_refused(origin: str) -> None:
    ended = CliRunner().invoke(app, ["foxglove", "--origin", origin])
    assert ended.exit_code == 1
    assert "such as https://app.foxglove.dev" in ended.stderr


def test_what_is_nested_too_deep_ends_its_connection_and_is_no_bug(
    usual: Serving, caplog: pytest.LogCaptureFixture
) -> None:
    with usual.opened() as client:
        client.send("[" * 100_000)
        with pytest.raises(ConnectionClosed) as closed:
            while True:
                client.recv(timeout=PATIENCE_S)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008
    assert "Traceback" not in caplog.text
