"""The HTTP server, in a thread of its own beside the runtime's."""

import asyncio
import logging
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn
from starlette.types import ASGIApp

from actum.settings import SettingsError
from web_dashboard.orders import LONGEST_ORDER_BYTES

PORTS = range(8080, 8180)
"""The ports that are tried where none is set."""
EVERYWHERE = ("0.0.0.0", "::")
"""The hosts that stand for all of a machine's addresses; a browser needs its name."""
PING_S = 20.0
"""Interval (s) of the WebSocket's pings, and how long each may take: then a browser that is gone is forgotten."""
ENDING_S = 1
"""How long (s) connections may take to close at the end."""


def bound_socket(host: str, port: int | None) -> socket.socket:
    """Return a socket bound to an address: to the port, or where that is None to the first of `PORTS` that is free.

    Raises:
        SettingsError: it cannot be bound.
    """
    problem: OSError | None = None
    for candidate in PORTS if port is None else (port,):
        try:
            return socket_at(host, candidate)
        except OSError as error:
            problem = error
    ports = f"port {port}" if port is not None else f"ports {PORTS.start} to {PORTS.stop - 1}"
    raise SettingsError(
        f"the web page cannot be served on {ports} of {host} ({problem}): choose another --page-port or --page-host"
    )


def socket_at(host: str, port: int) -> socket.socket:
    """Return a socket that listens at an address.

    Raises:
        OSError: it cannot be bound.
    """
    family, kind, protocol, _, address = socket.getaddrinfo(
        host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    bound = socket.socket(family, kind, protocol)
    try:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
        bound.listen()
    except OSError:
        bound.close()
        raise
    return bound


class PageServer:
    """Serves an application on a socket.

    Attributes:
        address: the address to open in a browser.
    """

    def __init__(self, application: ASGIApp, listening: socket.socket, host: str) -> None:
        self._socket = listening
        named = socket.gethostname() if host in EVERYWHERE else host
        shown = f"[{named}]" if ":" in named else named
        self.address = f"http://{shown}:{listening.getsockname()[1]}/"
        self._server = uvicorn.Server(
            uvicorn.Config(
                application,
                log_config=None,
                access_log=False,
                log_level=logging.WARNING,
                server_header=False,
                proxy_headers=False,
                ws="websockets-sansio",
                ws_max_size=LONGEST_ORDER_BYTES,
                ws_ping_interval=PING_S,
                ws_ping_timeout=PING_S,
                ws_per_message_deflate=False,  # it would cost more than the network of a laboratory gains
                timeout_graceful_shutdown=ENDING_S,
            )
        )
        self._thread = threading.Thread(target=self._serve, daemon=True)

    @contextmanager
    def serving(self) -> Iterator[None]:
        """Serve until left."""
        self._thread.start()
        try:
            yield
        finally:
            self._server.should_exit = True
            self._thread.join(timeout=2 * ENDING_S)
            self._socket.close()

    @property
    def working(self) -> bool:
        """Whether the server's thread runs."""
        return self._thread.is_alive()

    def _serve(self) -> None:
        asyncio.run(self._server.serve(sockets=[self._socket]))
