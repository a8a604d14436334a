"""The embedded router: a Zenoh session in router mode."""

import logging
import threading
from pathlib import Path

import zenoh

from actum.runtime.credentials import CERTIFICATE, USERS, check, is_renewed, login_values, router_values
from actum.runtime.health_file import HealthFile
from actum.runtime.session import TRANSPORT, insert
from actum.runtime.waiting import wait_for
from actum.settings import SettingsError

log = logging.getLogger("actum")

LOOK_S = 1.0
"""Interval (s) at which a router looks whether it works, and whether its certificate was renewed."""


def router_config(
    listen: str | None, config_file: Path | None, credentials: Path | None = None, link: str | None = None
) -> zenoh.Config:
    """Build the router's configuration from a JSON5 file or the defaults, with the endpoint to listen on.

    `link` is the endpoint of another host's router, which is connected to for as long as it takes.

    Raises:
        zenoh.ZError: the file or the endpoint is refused.
        SettingsError: the credentials cannot be used.
    """
    config = zenoh.Config.from_file(config_file) if config_file else _default_config()
    if listen is not None:
        insert(config, {"listen/endpoints": [listen]})
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

    The health file is touched every second while the router answers queries of what it is. A router reads its
    certificate only when it begins to listen. Its clients, which then lose it for some tenths of a second, show theirs
    anew each time they connect.

    Raises:
        SettingsError: the endpoint is taken, or the configuration or the credentials are refused.
    """
    health = HealthFile(health_file)
    while not stop.is_set():
        session = _opened(listen, config_file, credentials, link)
        log.info("router %s listens on %s", session.zid(), listen or config_file)
        try:
            _wait_for_renewal(session, credentials, health, stop)
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
        raise SettingsError(f"no router can be started on {listen or config_file}: {reason}") from None


def _wait_for_renewal(
    session: zenoh.Session, credentials: Path | None, health: HealthFile, stop: threading.Event
) -> None:
    """Wait until stopped, or until the folder holds another certificate that can be used; keep the health file."""
    shown = (credentials / CERTIFICATE).read_bytes() if credentials else b""
    while credentials is None or not is_renewed(credentials, shown):
        health.write(any(session.get(f"@/{session.zid()}/router", timeout=LOOK_S)))
        if wait_for(stop, LOOK_S):
            return
    log.info("the certificate in %s was renewed: listening anew", credentials)


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
