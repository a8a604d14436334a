"""Finds why this machine and a router do not trust each other over TLS: the certificate of either side."""

import json
import socket
import ssl
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import zenoh

from actum.runtime.credentials import TLS

CONNECT_S = 3.0
"""How long (s) a host may take to answer: a router in the same building needs milliseconds."""
ALERT_S = 2.0
"""How long (s) to wait for a router's refusal, which comes after the handshake."""
NO_CHECK_TIME = ssl.VerifyFlags(0x200000)
"""OpenSSL's X509_V_FLAG_NO_CHECK_TIME: a certificate's dates are to be read, also where they are past."""
TURNS = 4
"""Turns of both sides in a handshake with oneself: more than TLS 1.3 takes."""

_STRANGER = (
    "the router does not trust the authority that signed {certificate}: use credentials that 'actum deploy' made for "
    "this router"
)
_NO_TLS = (
    "port {port} of {host} does not use TLS: write tcp/ instead of tls/ in ACTUM_CONNECT, or restart the router if it "
    "is frozen"
)
_REFUSED = {
    "CERTIFICATE_REQUIRED": (
        "the router requires a certificate: set ACTUM_CREDENTIALS to the credentials folder of this program"
    ),
    "UNKNOWN_CA": _STRANGER,
    "DECRYPT_ERROR": _STRANGER,  # an authority of the same name, with another key
    "CERTIFICATE_EXPIRED": "the router refuses {certificate} as out of date: check the clock of the router's host",
}
"""What it means that a router breaks off, by the end of OpenSSL's name for its alert."""
_DISTRUSTED = {
    9: "the router's certificate is not valid yet: check the clocks of this machine and of the router's host",
    10: "the router's certificate expired on {ends}: renew it with 'actum deploy rotate'",
    62: "the router's certificate is for {names}, not for {host}: use one of these names in ACTUM_CONNECT",
    64: "the router's certificate is for {names}, not for {host}: use one of these names in ACTUM_CONNECT",
}
"""What it means that OpenSSL does not trust a router, by its number of the reason."""


@dataclass(frozen=True)
class Tls:
    """How a session makes itself known and knows its router: files, None where none is named."""

    authority: str | None
    certificate: str | None
    key: str | None
    by_name: bool
    """Whether the router's certificate has to name the host."""

    @classmethod
    def of(cls, config: zenoh.Config) -> "Tls":
        """Read it from a session's configuration."""
        tls = json.loads(config.get_json(TLS))
        return cls(
            authority=tls["root_ca_certificate"],
            certificate=tls["connect_certificate"],
            key=tls["connect_private_key"],
            by_name=tls["verify_name_on_connect"] is not False,
        )


def fault(host: str, port: int, tls: Tls) -> str | None:
    """Return why one side does not trust the other, and what to do; None where both do.

    Raises:
        OSError: the host cannot be connected to.
    """
    return _own_fault(tls) or _routers_fault(host, port, tls) or _refused(host, port, tls)


def speaks_tls(host: str, port: int) -> bool:
    """Tell whether what listens there speaks TLS, whether it lets us in or not."""
    context = _context(Tls(authority=None, certificate=None, key=None, by_name=False))
    context.verify_mode = ssl.CERT_NONE
    try:
        _connected(context, host, port).close()
    except ssl.SSLError as error:
        return "ALERT" in (error.reason or "")
    except OSError:
        return False
    return True


def _own_fault(tls: Tls) -> str | None:
    """Return why nobody who knows our authority can accept our certificate; None where he can."""
    if tls.certificate is None or tls.authority is None:
        return None
    try:
        own = _own_certificate(tls)
    except ssl.SSLError as error:
        problem = getattr(error, "verify_message", None) or error.reason
        return (
            f"{tls.certificate} is not signed by the authority in {tls.authority} ({problem}): use the certificate "
            "and the authority of the same credentials folder"
        )
    begin, end = own["notBefore"], own["notAfter"]
    if time.time() > ssl.cert_time_to_seconds(end):
        return f"{tls.certificate} expired on {end}: renew this certificate with 'actum deploy rotate'"
    if time.time() < ssl.cert_time_to_seconds(begin):
        return f"{tls.certificate} is not valid before {begin}: check this machine's clock"
    return None


def _own_certificate(tls: Tls) -> dict[str, Any]:
    """Return the fields of our certificate, which Python reads only where it comes in a handshake: one with ourselves.

    Raises:
        ssl.SSLError: our authority did not sign it.
    """
    accepting, showing = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER), ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    showing.check_hostname, showing.verify_mode = False, ssl.CERT_NONE
    for context in (accepting, showing):
        context.load_cert_chain(str(tls.certificate), tls.key)
    accepting.load_verify_locations(tls.authority)
    accepting.verify_mode, accepting.verify_flags = ssl.CERT_REQUIRED, accepting.verify_flags | NO_CHECK_TIME
    to, back = ssl.MemoryBIO(), ssl.MemoryBIO()
    sides = showing.wrap_bio(back, to), accepting.wrap_bio(to, back, server_side=True)
    for side in sides * TURNS:
        with suppress(ssl.SSLWantReadError):
            side.do_handshake()
    return sides[1].getpeercert() or {}


def _routers_fault(host: str, port: int, tls: Tls) -> str | None:
    """Return why we do not accept the router's certificate; None where we do."""
    context = _context(tls)
    try:
        _connected(context, host, port).close()
    except ssl.SSLCertVerificationError as error:
        if error.verify_code not in _DISTRUSTED:
            authority = (
                f"the authority in {tls.authority}" if tls.authority else "an authority that this machine trusts"
            )
            return (
                f"the router's certificate is not signed by {authority} ({error.verify_message}): use credentials that "
                "'actum deploy' made for this router"
            )
        return _DISTRUSTED[error.verify_code].format(host=host, **_routers_certificate(host, port, tls))
    except ssl.SSLError as error:
        return None if "ALERT" in (error.reason or "") else _NO_TLS.format(port=port, host=host)
    except TimeoutError:
        return _NO_TLS.format(port=port, host=host)
    return None


def _routers_certificate(host: str, port: int, tls: Tls) -> dict[str, str]:
    """Return when the router's certificate ends and the names that it is for."""
    context = _context(tls)
    context.check_hostname, context.verify_flags = False, context.verify_flags | NO_CHECK_TIME
    with _connected(context, host, port) as connection:
        shown: Any = connection.getpeercert() or {}
    return {"ends": shown["notAfter"], "names": ", ".join(name for _, name in shown.get("subjectAltName", ()))}


def _refused(host: str, port: int, tls: Tls) -> str | None:
    """Return why the router breaks off after the handshake, which shows it our certificate; None if it goes on."""
    try:
        with _connected(_context(tls), host, port) as connection:
            connection.settimeout(ALERT_S)
            connection.recv(1)
    except TimeoutError:
        return None  # it waits for what Zenoh would say now
    except ssl.SSLError as error:
        alert = error.reason or str(error)
        for end, meaning in _REFUSED.items():
            if alert.endswith(end):
                return meaning.format(certificate=tls.certificate)
        shown = tls.certificate or "clients without a certificate"
        reason = alert.lower().replace("_", " ")
        return f"the router refuses {shown} ({reason}): use credentials that 'actum deploy' made for this router"
    return None


def _context(tls: Tls) -> ssl.SSLContext:
    context = ssl.create_default_context(cafile=tls.authority)
    context.verify_flags &= ~ssl.VERIFY_X509_STRICT  # Python 3.13 sets it; Zenoh does not ask for those extensions
    context.check_hostname = tls.by_name
    if tls.certificate is not None:
        context.load_cert_chain(tls.certificate, tls.key)
    return context


def _connected(context: ssl.SSLContext, host: str, port: int) -> ssl.SSLSocket:
    return context.wrap_socket(socket.create_connection((host, port), CONNECT_S), server_hostname=host)
