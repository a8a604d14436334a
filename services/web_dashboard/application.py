"""The web application: the page's files, and the WebSocket by which a browser gets messages and gives orders."""

import asyncio
import base64
import hashlib
import logging
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from actum import __version__
from actum.skeletons import JOINTS, PARTS
from web_dashboard.admission import MISDIRECTED, Admission, Guarding, Rule
from web_dashboard.encoding import text
from web_dashboard.hub import Envelope, Hub, Mailbox
from web_dashboard.orders import LONGEST_ORDER_BYTES, Orders
from web_dashboard.settings import Settings

log = logging.getLogger("actum")

PAGE = Path(__file__).parent / "page"
PULSE_S = 0.5
"""Interval of the pulses (s): a page that hears none for a few seconds says so."""
DESCRIBING_S = 5.0
"""Interval (s) at which the services are asked for their descriptions while somebody watches."""
PACE_S = 1 / 40
"""Least interval (s) of what is sent to one browser: a little less than that of frames and screens."""
MOST_BROWSERS = 32
"""Pages open at a time."""
MOST_ORDERS = 32
"""Orders of one browser that wait for their answers."""
TRY_LATER = 1013
"""The WebSocket code of a server that has too much to do."""


def application(settings: Settings, hub: Hub, orders: Orders) -> Starlette:
    """Build the application."""
    html = (PAGE / "index.html").read_text(encoding="utf-8")

    async def page(_request: Request) -> Response:
        return HTMLResponse(html)

    async def connection(socket: WebSocket) -> None:
        await Connection(socket, hub, orders).serve(_greeting(settings))

    @asynccontextmanager
    async def lifespan(_app: Starlette) -> AsyncIterator[None]:
        tasks = [asyncio.create_task(_pulse(settings, hub, orders)), asyncio.create_task(_describe(hub, orders))]
        for task in tasks:
            task.add_done_callback(lambda ended: _tell_bug(ended, orders))
        yield
        for task in tasks:
            task.cancel()

    return Starlette(
        routes=[Route("/", page), Mount("/page", StaticFiles(directory=PAGE)), WebSocketRoute("/ws", connection)],
        middleware=[
            Middleware(Guarding, policy=policy(html)),
            Middleware(Admission, rule=_rule(settings), refused=orders.refused.append),
        ],
        lifespan=lifespan,
    )


def policy(html: str) -> str:
    """Return the content security policy: nothing from elsewhere, no inline script but the page's import map."""
    [import_map] = re.findall(r'<script type="importmap">(.*?)</script>', html, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(import_map.encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'self' 'sha256-{digest}'; style-src 'self'; img-src 'self' data: blob:; "
        "media-src 'self' blob:; connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )


def _rule(settings: Settings) -> Rule:
    advice = {MISDIRECTED: "--page-names can list it"}
    return Rule(settings.page_host, settings.page_names, settings.page_token, advice=advice)


class Connection:
    """One browser: what it is sent, and the orders it gives."""

    def __init__(self, socket: WebSocket, hub: Hub, orders: Orders) -> None:
        self._socket = socket
        self._hub = hub
        self._orders = orders
        self._wake = asyncio.Event()
        loop = asyncio.get_running_loop()
        self._mailbox = Mailbox(lambda: loop.call_soon_threadsafe(self._wake.set))
        self._waiting: set[asyncio.Task[None]] = set()

    async def serve(self, greeting: str) -> None:
        """Serve it until it goes."""
        if self._hub.browsers >= MOST_BROWSERS:
            self._orders.refuse(None, f"{MOST_BROWSERS} pages are open already")
            await self._socket.close(TRY_LATER)
            return
        await self._socket.accept()
        await self._socket.send_text(greeting)
        self._hub.join(self._mailbox)
        tasks = [asyncio.create_task(self._send()), asyncio.create_task(self._receive())]
        try:
            ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in ended:
                task.result()  # a bug ends the connection and is logged; the page connects anew
        finally:
            self._orders.leave(self)
            self._hub.leave(self._mailbox)
            for task in (*tasks, *self._waiting):
                task.cancel()

    async def _send(self) -> None:
        """Send what waits; several texts at a time go as one, a line for each."""
        with suppress(WebSocketDisconnect, RuntimeError):
            while await self._wake.wait():
                self._wake.clear()
                payloads = self._mailbox.empty()
                texts = [payload for payload in payloads if isinstance(payload, str)]
                if texts:
                    await self._socket.send_text("\n".join(texts))
                for payload in payloads:
                    if isinstance(payload, bytes):
                        await self._socket.send_bytes(payload)
                await asyncio.sleep(PACE_S)

    async def _receive(self) -> None:
        """Take orders until the browser goes."""
        while (received := await self._socket.receive())["type"] == "websocket.receive":
            if len(self._waiting) >= MOST_ORDERS:
                await self._socket.close(TRY_LATER)
                return
            task = asyncio.create_task(self._carry_out(received.get("text") or ""))
            self._waiting.add(task)
            task.add_done_callback(self._waiting.discard)

    async def _carry_out(self, order: str) -> None:
        answer = await self._orders.carry_out(order, self)
        with suppress(WebSocketDisconnect, RuntimeError):
            await self._socket.send_text(answer)


def _greeting(settings: Settings) -> str:
    """Return the first message to a browser."""
    return text(
        type="hello",
        version=__version__,
        sensor=settings.sensor,
        connect=settings.connect,
        joints=JOINTS,
        parts=dict(PARTS),
        longest_order_bytes=LONGEST_ORDER_BYTES,
    )


def _tell_bug(task: asyncio.Task[None], orders: Orders) -> None:
    """Log what ended a task that has no end, and end the server with it; a session that is closed meanwhile may."""
    if not task.cancelled() and orders.client is not None:
        log.error(
            "the web server of the page stops, because a bug occurred while it sent the services' state to the page: "
            "report the bug with the lines that follow",
            exc_info=task.exception(),
        )
        task.get_loop().stop()


async def _pulse(settings: Settings, hub: Hub, orders: Orders) -> None:
    """Publish to all browsers twice a second that the page is served, whether there is a router, and who is silent."""
    while True:
        connected = orders.client is not None and orders.client.connected()
        silent_s = {stream: s for stream, s in hub.silent_s().items() if stream.startswith("status/")}
        pulse = text(type="pulse", router=connected, connect=settings.connect, silent_s=silent_s)
        hub.publish(Envelope("pulse", pulse))
        await asyncio.sleep(PULSE_S)


async def _describe(hub: Hub, orders: Orders) -> None:
    """Ask the services now and then what they are, while somebody watches."""
    while True:
        client = orders.client
        if client is not None and hub.watched and client.connected():
            for info in await asyncio.to_thread(client.infos):
                fields = info.model_dump(exclude={"schemas", "joint_names"})
                hub.publish(Envelope(f"info/{info.service}", text(type="info", **fields), kept=True))
        await asyncio.sleep(DESCRIBING_S)
