"""The page's service without a router: what it is given, what browsers get of it, and what they ask for."""

import json
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from websockets.sync.client import ClientConnection, connect

from actum.messages import Message
from actum.node import Tick
from web_dashboard.node import WebDashboard
from web_dashboard.settings import Settings

PATIENCE_S = 10.0


@dataclass
class Colleague:
    """In the place of a client of a router: keeps what is put, and answers what is asked."""

    answer: Callable[..., dict[str, Any]] = lambda *_, **__: {}
    listened: bool = True
    router: bool = True
    put_messages: list[Message] = field(default_factory=list)

    def connected(self) -> bool:
        return self.router

    def put(self, message: Message) -> None:
        self.put_messages.append(message)

    def wait_for_subscriber(self, _topic: object, _timeout_s: float) -> bool:
        return self.listened

    def ask(self, service: str, command: str, **fields: Any) -> dict[str, Any]:
        return self.answer(service, command, **fields)

    def infos(self) -> list[Message]:
        return []


@dataclass
class Served:
    """A dashboard that serves, and its colleague."""

    node: WebDashboard
    colleague: Colleague

    @property
    def address(self) -> str:
        return self.node.counters.details["page"]

    @property
    def host(self) -> str:
        return urlsplit(self.address).netloc

    def give(self, *messages: Message) -> None:
        for message in messages:
            assert not list(self.node.handle(message))

    def browser(self, host: str | None = None, **options: Any) -> ClientConnection:
        """Open a WebSocket, as the page does; `host` stands in the request where it is given."""
        headers = options.pop("headers", None)
        opened = socket.create_connection(("127.0.0.1", int(self.host.rpartition(":")[2])))
        return connect(
            f"ws://{host or self.host}/ws", sock=opened, additional_headers=headers, max_size=None, **options
        )

    def rejects(self) -> dict[str, int]:
        self.node.handle(Tick(0))
        return dict(self.node.counters.rejects)


@contextmanager
def served(colleague: Colleague | None = None, **settings: Any) -> Iterator[Served]:
    """Serve a page on a free port."""
    node = WebDashboard.configured(Settings(page_port=0, **settings))
    made = Served(node, colleague or Colleague())
    node.attach(made.colleague)  # type: ignore[arg-type]
    with node.serving():
        yield made


def heard(browser: ClientConnection, kind: str, patience_s: float = PATIENCE_S) -> dict[str, Any]:
    """Read until a message of a type comes; an image comes with its bytes as `data`."""
    while True:
        received = browser.recv(timeout=patience_s)
        for message in parsed(received):
            if message.get("type") == kind:
                return message


def parsed(received: str | bytes) -> list[dict[str, Any]]:
    if isinstance(received, str):
        return [json.loads(line, parse_constant=_no_constant) for line in received.split("\n")]
    end = 4 + int.from_bytes(received[:4], "little")
    return [json.loads(received[4:end]) | {"data": received[end:]}]


def _no_constant(text: str) -> None:
    raise AssertionError(f"{text} is no JSON that a browser reads")


def answered(browser: ClientConnection, order: object) -> dict[str, Any]:
    """Give an order, as text or as fields, and read until its answer."""
    browser.send(order if isinstance(order, str) else json.dumps(order))
    while True:
        for message in parsed(browser.recv(timeout=PATIENCE_S)):
            if "type" not in message:
                return message
