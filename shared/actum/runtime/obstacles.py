"""Finds why a session to a router only times out: the name, the host, the port, the user, or TLS on either side."""

import errno
import json
import socket

from actum.runtime.credentials import LOGIN, login_values
from actum.runtime.session import client_config
from actum.runtime.tls_faults import CONNECT_S, Tls, fault, speaks_tls
from actum.settings import ServiceSettings, host_and_port


def obstacle(settings: ServiceSettings) -> str:
    """Return why no router answers where the settings say, and what to do; "" where nothing is found.

    Raises:
        SettingsError: the settings themselves cannot be used.
    """
    there = host_and_port(settings.connect) if settings.connect.startswith(("tcp/", "tls/")) else None
    if there is None:
        return ""
    try:
        socket.create_connection(there, CONNECT_S).close()
        return _between_sessions(settings, *there)
    except OSError as error:
        return _on_the_way(error, *there)


def _on_the_way(error: OSError, host: str, port: int) -> str:
    """Say what it means that a host cannot be connected to."""
    if isinstance(error, socket.gaierror):
        return (
            f"this machine cannot resolve the name {host} ({error.strerror}): correct the name, or use the host's IP "
            "address"
        )
    if isinstance(error, TimeoutError):
        return (
            f"{host} does not answer: check that this host is switched on and connected, and that firewalls allow "
            f"port {port}"
        )
    if isinstance(error, ConnectionRefusedError):
        return (
            f"nothing listens on port {port} of {host}: start a router with 'actum router', or set ACTUM_CONNECT to "
            "the address of a running router"
        )
    if error.errno in (errno.EHOSTUNREACH, errno.ENETUNREACH, errno.EHOSTDOWN):
        return f"there is no route to {host} ({error.strerror}): check this machine's network connection"
    return f"{host} closes the connection ({error.strerror or error}): check that a router listens on port {port}"


def _between_sessions(settings: ServiceSettings, host: str, port: int) -> str:
    """Say why a router opens no session although it can be connected to."""
    if settings.connect.startswith("tls/"):
        config = client_config(settings)
        user = json.loads(config.get_json(f"{LOGIN}/user"))
        return fault(host, port, Tls.of(config)) or _with_user(settings, user)
    if speaks_tls(host, port):
        address = settings.connect.removeprefix("tcp/")
        return (
            f"the router requires TLS: set ACTUM_CONNECT=tls/{address}, and ACTUM_CREDENTIALS to this program's "
            "credentials folder"
        )
    return (
        f"port {port} accepts connections, but no router answers there. Possible causes: another program listens on "
        "this port; the router is frozen (restart the router); the router requires a user name and a password (set "
        "both in the file that ACTUM_ZENOH_CONFIG names)"
    )


def _with_user(settings: ServiceSettings, user: str | None) -> str:
    """Say why a router whose certificate fits opens no session."""
    login = login_values(settings.credentials) if settings.credentials else {}
    name = login.get(f"{LOGIN}/user", user)
    cause = f"rejects the login of user {name}" if name else "requires a user name and a password"
    return (
        f"TLS works, but the router opens no session. If the router {cause}, copy this program's credentials folder to "
        "this machine again. If the router is frozen, restart the router"
    )
