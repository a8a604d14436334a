"""The embedded router: a Zenoh session in router mode."""

import logging
import os
import sys
import threading
from pathlib import Path

import zenoh

from actum.health import HealthFile
from actum.runtime.credentials import CERTIFICATE, USERS, check, login_values, router_values
from actum.runtime.session import TRANSPORT, insert, reason_of
from actum.runtime.stopping import wait_for
from actum.settings import DEFAULT_ENDPOINT, SettingsError

log = logging.getLogger("actum")

LISTEN = "listen/endpoints"
"""Where Zenoh's configuration has the endpoints that a router listens on."""
DEFAULTS = {
    "mode": "router",
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    **TRANSPORT,
    "adminspace/enabled": True,
}
"""The configuration of a router without a file of its own."""
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
    config = zenoh.Config.from_file(config_file) if config_file else zenoh.Config()
    if not config_file:
        insert(config, DEFAULTS)
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
    """Run a router until stopped; once its credentials have been renewed, or its configuration changed, start it anew.

    The health file is touched every second while the router answers queries of what it is. A router reads its
    certificate, and who may do what, only when it begins to listen. Its clients, which then lose it for a second or
    two, show theirs anew each time they connect.

    The process is then replaced by one with the same command line, and the session is not closed before: Zenoh 1.10
    sometimes panics, and may hang, where linked routers close their sessions at the same time.

    Raises:
        SettingsError: the endpoint is taken, or the configuration or the credentials are refused.
    """
    read = _contents(config_file, credentials)
    session = _opened(listen, config_file, credentials, link)
    log.info("router %s listens on %s", session.zid(), listen or config_file)
    if _changed(session, credentials, config_file, read, HealthFile(health_file), stop):
        log.info("the credentials in %s or the configuration has changed: the router starts anew", credentials)
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
    session.close()


def _opened(listen: str | None, config_file: Path | None, credentials: Path | None, link: str | None) -> zenoh.Session:
    try:
        config = router_config(listen, config_file, credentials, link)
        if credentials is not None:
            insert(config, login_values(credentials))
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise SettingsError(
            f"the router cannot start with {listen or config_file} ({reason_of(error)}): correct this address or "
            "configuration file"
        ) from None


def _changed(
    session: zenoh.Session,
    credentials: Path | None,
    config_file: Path | None,
    read: list[bytes],
    health: HealthFile,
    stop: threading.Event,
) -> bool:
    """Wait until stopped, or until the files that were read are others that can be used: then True.

    The health file is kept meanwhile.
    """
    while _contents(config_file, credentials) == read or not _usable(config_file, credentials):
        health.write(any(session.get(f"@/{session.zid()}/router", timeout=LOOK_S)))
        if wait_for(stop, LOOK_S):
            return False
    return True


def _contents(config_file: Path | None, credentials: Path | None) -> list[bytes]:
    """Return what the files hold that a router reads when it begins to listen; nothing where one cannot be read.

    They are read before it begins: a deployment writes them one after another, while the router runs.
    """
    files = [config_file] if config_file else []
    if credentials:
        files += [credentials / CERTIFICATE, credentials / USERS]
    return [_content(file) for file in files]


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b""


def _usable(config_file: Path | None, credentials: Path | None) -> bool:
    """Tell whether a router could begin to listen with the files as they are now: whole, and of one another."""
    try:
        if config_file:
            zenoh.Config.from_json5(config_file.read_text(encoding="utf-8"))
        if credentials:
            check(credentials)
    except (OSError, UnicodeDecodeError, zenoh.ZError, SettingsError):
        return False
    return True
