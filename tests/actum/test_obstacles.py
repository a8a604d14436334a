"""Why no router answers, where what listens is no router."""

import socketserver
import threading
from collections.abc import Iterator

import pytest

from actum.runtime.obstacles import obstacle
from actum.settings import ServiceSettings


class WebServer(socketserver.BaseRequestHandler):
    """Answers whatever comes as web servers answer what is no request."""

    def handle(self) -> None:
        self.request.recv(1000)
        self.request.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")


@pytest.fixture
def port() -> Iterator[int]:
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), WebServer) as server:
        threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        yield server.server_address[1]
        server.shutdown()


@pytest.mark.parametrize(
    ("scheme", "reason"),
    [("tls", "port {port} of 127.0.0.1 does not use TLS"), ("tcp", "port {port} accepts connections, but no router")],
)
def test_a_web_server_is_no_router(port: int, scheme: str, reason: str) -> None:
    said = obstacle(ServiceSettings(connect=f"{scheme}/127.0.0.1:{port}"))
    assert said.startswith(reason.format(port=port))
