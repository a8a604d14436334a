"""A server of Foxglove's WebSocket protocol, `foxglove.sdk.v1`, that websites cannot open.

Foxglove's own server accepts whoever shakes hands, also a page of any site that the user's browser has open.
"""

import asyncio
import base64
import json
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.routing import WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from web_dashboard.admission import Admission, Rule
from web_dashboard.hub import Envelope, Mailbox

SUBPROTOCOL = "foxglove.sdk.v1"
"""The protocol's name in the handshake."""
MESSAGE = struct.Struct("<BIQ")
"""The head of a message: 1, the subscription, the log time (ns)."""
MOST_CLIENTS = 32
"""Clients at a time: 32 MB may wait for each."""
MOST_SUBSCRIPTIONS = 1000
"""Subscriptions of one client: some tens of topics are served, and each is subscribed to once."""
UNUSABLE, TRY_LATER = 1008, 1013
"""The WebSocket codes of a client that speaks otherwise, and of a server that has too much to do."""


@dataclass(frozen=True)
class Channel:
    """A topic with the encoding of its messages and their schema."""

    topic: str
    encoding: str
    schema_name: str
    schema_encoding: str
    schema: bytes


class Client:
    """What a client has subscribed to, as channels by the client's numbers, and what it has not been sent yet."""

    def __init__(self, mailbox: Mailbox) -> None:
        self.mailbox = mailbox
        self._channels: dict[int, int] = {}
        self._lock = threading.Lock()

    def give(self, channel: int, payload: bytes, time_ns: int) -> None:
        """Have a message of a channel sent once for each subscription to it."""
        with self._lock:
            numbers = [number for number, its in self._channels.items() if its == channel]
        heads = [MESSAGE.pack(1, number, time_ns) for number in numbers]
        self.mailbox.put(Envelope("messages", head + payload, queued=True) for head in heads)

    def receive(self, text: str) -> bool:
        """Subscribe or unsubscribe as a request says; tell whether it was for a subscription.

        Raises:
            ValueError, TypeError, KeyError, AttributeError, RecursionError: it is no request.
        """
        request = json.loads(text)
        if request["op"] == "subscribe":
            wanted = {_number(each["id"]): _number(each["channelId"]) for each in request["subscriptions"]}
            with self._lock:
                if len({*self._channels, *wanted}) > MOST_SUBSCRIPTIONS:
                    raise ValueError(
                        f"the viewer requests more than {MOST_SUBSCRIPTIONS} topics: close some panels of the viewer"
                    )
                self._channels.update(wanted)
            return True
        if request["op"] == "unsubscribe":
            with self._lock:
                for number in request["subscriptionIds"]:
                    self._channels.pop(_number(number), None)
        return False


class FoxgloveServer:
    """Serves channels to clients; messages may be put from another thread than the server's."""

    def __init__(self, subscribed: threading.Event) -> None:
        self._subscribed = subscribed
        self._channels: list[Channel] = []
        self._clients: list[Client] = []
        self._lock = threading.Lock()
        self._session = str(time.time_ns())
        self._left_out = 0

    @property
    def left_out(self) -> int:
        """How many messages clients did not get since the start, because they took none for too long."""
        with self._lock:
            return self._left_out + sum(client.mailbox.left_out for client in self._clients)

    def application(self, rule: Rule, refused: Callable[[str], object]) -> Starlette:
        """Build the web application, which lets in whom a rule admits."""
        return Starlette(
            routes=[WebSocketRoute("/", self._connection)],
            middleware=[Middleware(Admission, rule=rule, refused=refused)],
        )

    def open(self, channel: Channel) -> Callable[[bytes, int], None]:
        """Add a channel, and return what puts a payload with its time (ns) on it."""
        with self._lock:
            self._channels.append(channel)
            number = len(self._channels)
            for client in self._clients:
                client.mailbox.put([Envelope(f"channel {number}", _advertised({number: channel}))])

        def log(payload: bytes, time_ns: int) -> None:
            with self._lock:
                clients = [*self._clients]
            for client in clients:
                client.give(number, payload, time_ns)

        return log

    async def _connection(self, socket: WebSocket) -> None:
        if SUBPROTOCOL not in socket.scope["subprotocols"] or len(self._clients) >= MOST_CLIENTS:
            await socket.close(TRY_LATER)
            return
        await socket.accept(SUBPROTOCOL)
        wake, loop = asyncio.Event(), asyncio.get_running_loop()
        client = Client(Mailbox(lambda: loop.call_soon_threadsafe(wake.set)))
        server = {"op": "serverInfo", "name": "actum", "capabilities": [], "sessionId": self._session}
        with self._lock:
            first = [json.dumps(server), _advertised(dict(enumerate(self._channels, 1)))]
            client.mailbox.put(Envelope("first", text, queued=True) for text in first)
            self._clients.append(client)
        sending = asyncio.create_task(_send(socket, client.mailbox, wake))
        try:
            await self._receive(socket, client)
        finally:
            with self._lock:
                self._clients.remove(client)
                self._left_out += client.mailbox.left_out
            sending.cancel()

    async def _receive(self, socket: WebSocket, client: Client) -> None:
        """Take requests until the client goes, or says what is none."""
        while (received := await socket.receive())["type"] == "websocket.receive":
            try:
                if client.receive(received.get("text") or ""):
                    self._subscribed.set()
            except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
                await socket.close(UNUSABLE)
                return


async def _send(socket: WebSocket, mailbox: Mailbox, wake: asyncio.Event) -> None:
    """Send what waits, until the client goes."""
    with suppress(WebSocketDisconnect, RuntimeError):
        while await wake.wait():
            wake.clear()
            for payload in mailbox.empty():
                await (socket.send_text(payload) if isinstance(payload, str) else socket.send_bytes(payload))


def _advertised(channels: dict[int, Channel]) -> str:
    """Return what names channels to a client; a schema that is no text goes as base64."""
    described = [
        {
            "id": number,
            "topic": channel.topic,
            "encoding": channel.encoding,
            "schemaName": channel.schema_name,
            "schemaEncoding": channel.schema_encoding,
            "schema": (
                channel.schema.decode() if channel.encoding == "json" else base64.b64encode(channel.schema).decode()
            ),
        }
        for number, channel in channels.items()
    ]
    return json.dumps({"op": "advertise", "channels": described})


def _number(value: object) -> int:
    """Return a number of the protocol, which has 32 bits.

    Raises:
        ValueError: it is none.
    """
    if not isinstance(value, int) or not 0 <= value < 2**32:
        raise ValueError(f"{value!r} is not a whole number from 0 to 4294967295: use a whole number in this range")
    return value
