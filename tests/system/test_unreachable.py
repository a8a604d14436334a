"""Why no session opens is said in words: every fault here is a real one, between real processes."""

import json
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from actum.settings import ServiceSettings
from authorities import Authority
from live import System, free_endpoint, wait_until

pytestmark = pytest.mark.system


def said(running: System, connect: str, credentials: Path | None = None) -> str:
    """What doctor says of a router that it does not reach."""
    running.variables["ACTUM_CONNECT"] = connect
    if credentials is not None:
        running.variables["ACTUM_CREDENTIALS"] = str(credentials)
    ended = running.actum("doctor")
    assert ended.returncode == 1
    prefix = f"actum: no router answers at {connect}: "
    line = " ".join(ended.stderr.split())
    assert line.startswith(prefix), ended.stdout + line
    return line.removeprefix(prefix)


def test_a_name_that_nobody_knows(running: System) -> None:
    refused = said(running, "tcp/kinect-host.invalid:7447")
    assert refused.startswith("this machine cannot resolve the name kinect-host.invalid")


def test_a_port_on_which_nothing_listens(running: System) -> None:
    port = running.settings.connect.rpartition(":")[2]
    assert said(running, running.settings.connect).startswith(f"nothing listens on port {port} of 127.0.0.1: start")


def test_a_host_that_does_not_answer(running: System) -> None:
    """One whose queue of connections is full drops them, as a firewall does, or a host that is off."""
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen(0)
        with full(silent.getsockname()):
            port = silent.getsockname()[1]
            assert said(running, f"tcp/127.0.0.1:{port}").startswith(
                "127.0.0.1 does not answer: check that this host is switched on and connected"
            )


@contextmanager
def full(address: tuple[str, int]) -> Iterator[None]:
    waiting = [socket.socket() for _ in range(4)]
    try:
        for connection in waiting:
            connection.setblocking(False)
            connection.connect_ex(address)
        yield
    finally:
        for connection in waiting:
            connection.close()


def test_a_host_to_which_no_route_leads(running: System) -> None:
    """As in a network namespace of its own, in which not even the loopback is up."""
    alone = ["unshare", "--map-root-user", "--net"]
    if shutil.which("unshare") is None or subprocess.run([*alone, "true"], check=False).returncode != 0:
        pytest.skip("no network namespace can be made here")
    doctor = [sys.executable, "-m", "actum_command", "doctor"]
    ended = subprocess.run([*alone, *doctor], env=running.environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert "there is no route to 127.0.0.1 (Network is unreachable): check this machine's network" in ended.stderr


def test_a_router_that_is_frozen(running: System) -> None:
    router = running.start_router_process()
    with running.client():
        pass
    router.process.send_signal(signal.SIGSTOP)
    try:
        assert "accepts connections, but no router answers there" in said(running, running.settings.connect)
    finally:
        router.process.send_signal(signal.SIGCONT)


def started(running: System, credentials: Path, *configured: str) -> str:
    """Start a router that shows these credentials; return its endpoint by name."""
    endpoint = free_endpoint().replace("tcp/127.0.0.1", "tls/localhost")
    shown = ("--credentials", str(credentials), *configured)
    router = running.start("actum_command", "router", "--listen", endpoint, *shown)
    wait_until(lambda: "listens on" in router.said() or router.process.poll() is not None, "the router listens")
    assert router.process.poll() is None, router.said()
    return endpoint


@pytest.fixture
def authority(tmp_path: Path) -> Authority:
    return Authority(tmp_path / "authority")


def test_who_shows_what_the_router_knows_is_let_in(running: System, authority: Authority) -> None:
    running.variables["ACTUM_CONNECT"] = started(running, authority.role("router"))
    running.variables["ACTUM_CREDENTIALS"] = str(authority.role("viewer"))
    assert "action_fusion is not running" in " ".join(running.actum("doctor").stdout.split())


@pytest.mark.thorough
def test_a_certificate_of_another_authority(running: System, authority: Authority, tmp_path: Path) -> None:
    endpoint = started(running, authority.role("router"))
    stranger = Authority(tmp_path / "other").role("stranger")
    refused = said(running, endpoint, stranger)
    assert refused.startswith(f"the router's certificate is not signed by the authority in {stranger / 'ca.pem'}")
    shutil.copy(tmp_path / "authority" / "ca.pem", stranger)  # it knows the router now, and the router not it
    refused = said(running, endpoint, stranger)
    assert refused.startswith(f"{stranger / 'certificate.pem'} is not signed by the authority in {stranger / 'ca.pem'}")
    both = (tmp_path / "other" / "ca.pem").read_text() + (tmp_path / "authority" / "ca.pem").read_text()
    (stranger / "ca.pem").write_text(both)
    refused = said(running, endpoint, stranger)
    shown = stranger / "certificate.pem"
    assert refused.startswith(f"the router does not trust the authority that signed {shown}")


def test_no_certificate(running: System, authority: Authority, tmp_path: Path) -> None:
    endpoint = started(running, authority.role("router"))
    without = tmp_path / "without.json5"
    without.write_text(
        json.dumps({"transport": {"link": {"tls": {"root_ca_certificate": f"{tmp_path}/authority/ca.pem"}}}})
    )
    running.variables["ACTUM_ZENOH_CONFIG"] = str(without)
    assert said(running, endpoint).startswith("the router requires a certificate")


def test_an_expired_certificate(running: System, authority: Authority) -> None:
    endpoint = started(running, authority.role("router"))
    viewer = authority.role("viewer", days_left=-1)
    assert said(running, endpoint, viewer).startswith(f"{viewer / 'certificate.pem'} expired on ")


def test_an_expired_certificate_of_the_router(running: System, authority: Authority) -> None:
    endpoint = started(running, authority.role("router", days_left=-1))
    assert said(running, endpoint, authority.role("viewer")).startswith("the router's certificate expired on ")


def test_a_router_of_another_name(running: System, authority: Authority) -> None:
    endpoint = started(running, authority.role("router", host="kinect-host"))
    refused = said(running, endpoint, authority.role("viewer"))
    assert refused.startswith("the router's certificate is for kinect-host, not for localhost")


def test_a_wrong_password(running: System, authority: Authority) -> None:
    router, viewer = authority.role("router"), authority.role("viewer")
    (router / "users.txt").write_text("viewer:right\n")
    login = {"user": "viewer", "password": "wrong"}
    (viewer / "user.json5").write_text(json.dumps({"transport": {"auth": {"usrpwd": login}}}))
    refused = said(running, started(running, router), viewer)
    assert "If the router rejects the login of user viewer, copy" in refused
    assert "wrong" not in refused


@pytest.mark.thorough
def test_one_speaks_tls_and_the_other_does_not(running: System, authority: Authority) -> None:
    endpoint = started(running, authority.role("router"))
    assert said(running, endpoint.replace("tls/", "tcp/")).startswith("the router requires TLS: set ACTUM_CONNECT=tls/")
    plain = free_endpoint()
    running.start("actum_command", "router", "--listen", plain)
    with System(running.folder, ServiceSettings(connect=plain)).client():
        pass
    named = plain.replace("tcp/127.0.0.1", "tls/localhost")
    assert said(running, named, authority.role("viewer")).startswith(
        f"port {plain.rpartition(':')[2]} of localhost does not use TLS: write tcp/ instead of tls/"
    )
