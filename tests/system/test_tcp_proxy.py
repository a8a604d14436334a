"""The proxy does to a link what the tests of links say that it does."""

import contextlib
import socket
import threading
import time
from collections.abc import Iterator

import pytest
from benchmarks.rig import tcp_proxy
from benchmarks.rig.tcp_proxy import TcpProxy
from hypothesis import given, settings
from hypothesis import strategies as st

from live import wait_until

SLACK_S = 2.0  # what a busy machine may take on top


def echo(listener: socket.socket) -> None:
    """Send back what comes on each connection until the listener is closed."""
    while True:
        try:
            connection, _ = listener.accept()
        except OSError:
            return
        threading.Thread(target=echo_one, args=(connection,), daemon=True).start()


def echo_one(connection: socket.socket) -> None:
    with contextlib.suppress(OSError), connection:
        while chunk := connection.recv(65_536):
            connection.sendall(chunk)


@pytest.fixture(scope="module")
def echoing() -> Iterator[int]:
    """The port of a server that sends everything back."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=echo, args=(listener,), daemon=True).start()
        yield listener.getsockname()[1]
        listener.shutdown(socket.SHUT_RDWR)


@pytest.fixture
def proxy(echoing: int) -> Iterator[TcpProxy]:
    with TcpProxy(echoing, seed=3) as made:
        yield made


@pytest.fixture
def connection(proxy: TcpProxy) -> Iterator[socket.socket]:
    with connected(proxy.port) as made:
        yield made


def connected(port: int) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), 10.0)


def refuses(port: int) -> bool:
    """Whether a connection ends at once, be it before connect has returned."""
    try:
        with connected(port) as connection:
            return ended(connection)
    except ConnectionError:
        return True


def round_trip(connection: socket.socket, data: bytes) -> bytes:
    connection.sendall(data)
    return received(connection, len(data))


def received(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size and (chunk := connection.recv(65_536)):
        data += chunk
    return data


def ended(connection: socket.socket) -> bool:
    """Whether the other end has ended or reset the connection."""
    try:
        return connection.recv(1) == b""
    except ConnectionError:
        return True


@given(chunks=st.lists(st.binary(min_size=1, max_size=3000), min_size=1, max_size=8), jitter_s=st.floats(0.0, 0.01))
@settings(max_examples=20, deadline=None)
def test_every_byte_arrives_once_and_in_order(echoing: int, chunks: list[bytes], jitter_s: float) -> None:
    with TcpProxy(echoing) as proxy, connected(proxy.port) as connection:
        proxy.delay(0.01, jitter_s)
        for chunk in chunks:
            connection.sendall(chunk)
        assert received(connection, len(b"".join(chunks))) == b"".join(chunks)


def test_more_than_is_held_on_its_way_arrives(connection: socket.socket, proxy: TcpProxy) -> None:
    data = bytes(range(256)) * (3 * tcp_proxy.IN_FLIGHT_BYTES // 256)
    threading.Thread(target=connection.sendall, args=(data,), daemon=True).start()
    assert received(connection, len(data)) == data
    assert proxy.carried_bytes == (len(data), len(data))


def test_a_delay_is_put_on_either_direction(connection: socket.socket, proxy: TcpProxy) -> None:
    proxy.delay(0.2)
    began_s = time.monotonic()
    assert round_trip(connection, b"ping") == b"ping"
    assert 0.4 <= time.monotonic() - began_s < 0.4 + SLACK_S


def test_delays_differ_by_the_jitter(connection: socket.socket, proxy: TcpProxy) -> None:
    proxy.delay(0.05, 0.05)
    took_s = []
    for _ in range(20):
        began_s = time.monotonic()
        round_trip(connection, b"ping")
        took_s.append(time.monotonic() - began_s)
    assert min(took_s) < 0.1 < max(took_s)


def test_a_delay_does_not_slow_the_stream(connection: socket.socket, proxy: TcpProxy) -> None:
    """Bytes follow each other as they were sent; they do not wait for each other's delay."""
    proxy.delay(0.3)
    began_s = time.monotonic()
    for _ in range(20):
        connection.sendall(b"ping")
        time.sleep(0.01)  # so that each is a chunk of its own
    assert received(connection, 80) == b"ping" * 20
    assert time.monotonic() - began_s < 0.6 + 20 * 0.01 + SLACK_S


def test_a_stall_holds_everything_back_and_loses_nothing(connection: socket.socket, proxy: TcpProxy) -> None:
    assert round_trip(connection, b"before") == b"before"
    began_s = time.monotonic()
    proxy.stall(0.5)
    assert round_trip(connection, b"during") == b"during"
    assert 0.5 <= time.monotonic() - began_s < 0.5 + SLACK_S


def test_mending_ends_a_stall(connection: socket.socket, proxy: TcpProxy) -> None:
    proxy.stall(60.0)
    connection.sendall(b"ping")
    proxy.mend()
    assert received(connection, 4) == b"ping"


def test_a_cut_ends_connections_and_what_was_on_its_way(connection: socket.socket, proxy: TcpProxy) -> None:
    assert round_trip(connection, b"before") == b"before"
    proxy.delay(1.0)
    connection.sendall(b"on its way")
    proxy.cut()
    assert ended(connection)
    wait_until(lambda: proxy.connections == 0, "the connection is forgotten")


def test_nobody_connects_while_it_is_cut_and_everybody_afterwards(proxy: TcpProxy) -> None:
    proxy.cut()
    assert refuses(proxy.port)
    proxy.mend()
    with connected(proxy.port) as again:
        assert round_trip(again, b"after") == b"after"


def test_an_end_is_handed_on(connection: socket.socket, proxy: TcpProxy) -> None:
    round_trip(connection, b"ping")
    connection.shutdown(socket.SHUT_WR)
    assert ended(connection)
    wait_until(lambda: proxy.connections == 0, "the connection is forgotten")


def test_without_a_target_connections_end() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with TcpProxy(port) as proxy:
        assert refuses(proxy.port)


def test_its_port_is_free_afterwards(echoing: int) -> None:
    with TcpProxy(echoing) as proxy:
        pass
    with TcpProxy(echoing, port=proxy.port) as again, connected(again.port) as connection:
        assert round_trip(connection, b"ping") == b"ping"
