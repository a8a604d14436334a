"""The embedded router: a Zenoh session in router mode."""

import logging
import threading
from pathlib import Path

import zenoh

from actum.runtime.credentials import CERTIFICATE, USERS, check, is_renewed, login_values, router_values
from actum.runtime.health_file import HealthFile
from actum.runtime.session import TRANSPORT, insert
from actum.runtime.waiting import wait_for
from actum.settings import DEFAULT_ENDPOINT, SettingsError

log = logging.getLogger("actum")

LISTEN = "listen/endpoints"
"""Where Zenoh's configuration has the endpoints that a router listens on."""
LOOK_S = 1.0
"""Interval (s) at which a router looks whether it works, and whether its certificate was renewed."""


def router_config(
    listen: str | None, config_file: Path | None, credentials: Path | None = None, link: str | None = None
) -> zenoh.Config:
    """Build the router's configuration from a JSON5 file or the defaults, with the endpoint to listen on.

    Where neither `listen` nor the file names one, it is this machine's alone.

    `link` is the endpoint of another host's router, which is connected to for as long as it takes.

    Raises:
        zenoh.ZError: the file or the endpoint is refused.
        SettingsError: the credentials cannot be used.
    """
    config = zenoh.Config.from_file(config_file) if config_file else _default_config()
    if listen is None and config.get_json(LISTEN) == zenoh.Config().get_json(LISTEN):
        listen = DEFAULT_ENDPOINT  # Zenoh's own default is every interface
    if listen is not None:
        insert(config, {LISTEN: [listen]})
    if link is not None:
        insert(config, {"connect/endpoints": [link]})
    if credentials is not None:
        check(credentials)
        insert(config, router_values(credentials, passwords=(credentials / USERS).exists()))
    return config


def serve_router(
    listen: str | None,
    config_file: Path | None,
    stop: threading.Event,
    credentials: Path | None = None,
    health_file: Path | None = None,
    link: str | None = None,
) -> None:
    """Run a router until stopped; with a folder of credentials it is opened anew whenever these have been renewed.

    So it is when its file of configuration, which says who may do what, has been changed meanwhile.

    The health file is touched every second while the router answers queries of what it is. A router reads its
    certificate only when it begins to listen. Its clients, which then lose it for some tenths of a second, show theirs
    anew each time they connect.

    Raises:
        SettingsError: the endpoint is taken, or the configuration or the credentials are refused.
    """
    health = HealthFile(health_file)
    while not stop.is_set():
        read = _content(config_file)
        session = _opened(listen, config_file, credentials, link)
        log.info("router %s listens on %s", session.zid(), listen or config_file)
        try:
            _wait_for_renewal(session, credentials, config_file, read, health, stop)
        finally:
            session.close()


def _opened(listen: str | None, config_file: Path | None, credentials: Path | None, link: str | None) -> zenoh.Session:
    try:
        config = router_config(listen, config_file, credentials, link)
        if credentials is not None:
            insert(config, login_values(credentials))
        return zenoh.open(config)
    except zenoh.ZError as error:
        reason = " ".join(str(error).partition(" at /")[0].split())
        raise SettingsError(f"the router cannot start on {listen or config_file}: {reason}") from None


def _wait_for_renewal(
    session: zenoh.Session,
    credentials: Path | None,
    config_file: Path | None,
    read: bytes,
    health: HealthFile,
    stop: threading.Event,
) -> None:
    """Wait until stopped, or until certificate or configuration are others that can be used; keep the health file."""
    shown = _content(credentials / CERTIFICATE) if credentials else b""
    while credentials is None or not (is_renewed(credentials, shown) or _is_changed(config_file, read)):
        health.write(any(session.get(f"@/{session.zid()}/router", timeout=LOOK_S)))
        if wait_for(stop, LOOK_S):
            return
    log.info("the certificate in %s or the configuration has changed: the router restarts its listener", credentials)


def _content(file: Path | None) -> bytes:
    """Return what a file holds, nothing where it cannot be read now."""
    try:
        return file.read_bytes() if file else b""
    except OSError:
        return b""


def _is_changed(config_file: Path | None, read: bytes) -> bool:
    """Tell whether a file of configuration is another than the one that was read, and whole."""
    content = _content(config_file)
    if content in (b"", read):
        return False
    try:
        zenoh.Config.from_json5(content.decode())
    except (zenoh.ZError, UnicodeDecodeError):
        return False
    return True


def _default_config() -> zenoh.Config:
    config = zenoh.Config()
    values = {
        "mode": "router",
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        **TRANSPORT,
        "adminspace/enabled": True,
    }
    insert(config, values)
    return config
