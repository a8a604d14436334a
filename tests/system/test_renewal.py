"""Certificates are renewed while everything runs, and an expired one is of no use to who is connected already."""

import socket
import ssl
import threading
from pathlib import Path

import pytest
import zenoh
from cryptography import x509
from zenoh import ext, handlers

from actum import codec, keys
from actum.messages import Segment
from actum.runtime import Client
from actum.runtime.credentials import AUTHORITY, CERTIFICATE, KEY
from actum.runtime.session import connected, secret_config
from actum.settings import host_and_port
from actum_deployer.certificates import Signed, new_certificate, now
from actum_deployer.writing import write_deployment
from deployments import Deployed, deployed
from empty_messages import mark
from live import PATIENCE_S, wait_until

pytestmark = pytest.mark.system
DAYS_PER_S = 1 / 86_400
SHORT_S = 4.0
"""How long a certificate is valid that expires while it is in use (s)."""
MARK_S = 0.02
"""Interval of the marks that are put while certificates are renewed (s)."""
MORE = 20
"""Marks put before, and after all routers have begun anew: a mark that is lost is missed once another one comes."""


def shown_by(running: Deployed, host: str) -> int:
    """The serial number of the certificate that a host's router shows."""
    own = running.credentials("viewer")
    context = ssl.create_default_context(cafile=str(own / AUTHORITY))
    context.load_cert_chain(own / CERTIFICATE, own / KEY)
    address = host_and_port(running.endpoint(host))
    assert address is not None
    with (
        socket.create_connection(address) as plain,
        context.wrap_socket(plain, server_hostname=address[0]) as connection,
    ):
        shown = connection.getpeercert(binary_form=True)
    assert shown is not None
    return x509.load_der_x509_certificate(shown).serial_number


class Classifier:
    """Hears marks as the classifier does, which requests again those that it missed."""

    def __init__(self, running: Deployed) -> None:
        self.session = zenoh.open(secret_config(running.settings("classifier.kinect0", "compute")))
        self.heard: list[str] = []
        self._subscriber = ext.declare_advanced_subscriber(
            self.session,
            keys.key(keys.SEGMENT, "kinect0"),
            handlers.RingChannel(4096),
            recovery=ext.RecoveryConfig(heartbeat=True, periodic_queries=None),
        )

    def has_heard(self, count: int) -> bool:
        while (sample := self._subscriber.try_recv()) is not None:
            message = codec.decode(str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding))
            assert isinstance(message, Segment)
            self.heard.append(message.segment_id)
        return len(self.heard) >= count

    def close(self) -> None:
        self._subscriber.undeclare()
        self.session.close()


class Marking:
    """Puts marks, numbered, one after the other."""

    def __init__(self, client: Client) -> None:
        self.put: list[str] = []
        self._client = client

    def another(self) -> None:
        self.put.append(f"mark-{len(self.put)}")
        self._client.put(mark("start", len(self.put), self.put[-1]))
        threading.Event().wait(MARK_S)

    def until(self, done: bool) -> bool:
        self.another()
        return done


def test_marks_put_while_all_certificates_are_renewed_all_arrive(tmp_path: Path) -> None:
    with deployed(tmp_path) as running, running.client("switch", "camera") as switch:
        routers = list(running.running)
        before = {shown_by(running, host) for host in ("camera", "compute")}
        classifier, marking = Classifier(running), Marking(switch)
        assert switch.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
        wait_until(lambda: marking.until(classifier.has_heard(MORE)), "marks arrive")
        write_deployment(running.deployment, running.root, days=30)
        begun_anew = "every router listens anew"
        wait_until(lambda: marking.until(all(each.said().count("listens") == 2 for each in routers)), begun_anew)
        wait_until(lambda: marking.until(switch.connected() and connected(classifier.session)), "both are back")
        meanwhile = len(marking.put)
        wait_until(lambda: marking.until(classifier.has_heard(meanwhile + MORE)), "marks arrive again")
        assert classifier.heard == marking.put[: len(classifier.heard)]
        assert before.isdisjoint({shown_by(running, host) for host in ("camera", "compute")})
        classifier.close()


def test_who_is_connected_with_a_certificate_that_expires_is_cut_off_until_it_is_renewed(tmp_path: Path) -> None:
    with deployed(tmp_path) as running:
        authority = running.root / "authority"
        signed = Signed.load((authority / AUTHORITY).read_bytes(), (authority / KEY).read_bytes())
        short, longer = (new_certificate(signed, "viewer", now(), s * DAYS_PER_S) for s in (SHORT_S, 3600.0))
        install(running.credentials("viewer"), short)
        with running.client("viewer", "compute") as viewer:
            assert viewer.connected()
            wait_until(lambda: not viewer.connected(), "the expired certificate ends the connection")
            install(running.credentials("viewer"), longer)
            wait_until(viewer.connected, "the new one opens it again")


def install(folder: Path, signed: Signed) -> None:
    (folder / KEY).write_bytes(signed.key_pem)
    (folder / CERTIFICATE).write_bytes(signed.certificate_pem)
