"""The embedded router: a Zenoh session in router mode."""

import json
import logging
import threading
from pathlib import Path

import zenoh

from actum.runtime.session import TRANSPORT
from actum.runtime.waiting import wait_for
from actum.settings import SettingsError

log = logging.getLogger("actum")


def router_config(listen: str | None, config_file: Path | None) -> zenoh.Config:
    """Build the router's configuration from a JSON5 file or the defaults, with the endpoint to listen on.

    Raises:
        zenoh.ZError: the file or the endpoint is refused.
    """
    config = zenoh.Config.from_file(config_file) if config_file else _default_config()
    if listen is not None:
        config.insert_json5("listen/endpoints", json.dumps([listen]))
    return config


def serve_router(listen: str | None, config_file: Path | None, stop: threading.Event) -> None:
    """Run a router until stopped.

    Raises:
        SettingsError: the endpoint is taken, or the configuration is refused.
    """
    try:
        session = zenoh.open(router_config(listen, config_file))
    except zenoh.ZError as error:
        reason = " ".join(str(error).partition(" at /")[0].split())
        raise SettingsError(f"no router can be started on {listen or config_file}: {reason}") from None
    log.info("router %s listens on %s", session.zid(), listen or config_file)
    try:
        wait_for(stop)
    finally:
        session.close()


def _default_config() -> zenoh.Config:
    config = zenoh.Config()
    for path, value in {
        "mode": "router",
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        **TRANSPORT,
        "adminspace/enabled": True,
    }.items():
        config.insert_json5(path, json.dumps(value))
    return config
