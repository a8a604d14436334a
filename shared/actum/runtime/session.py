"""Opens a Zenoh session to the router, waiting for it until stopped."""

import json
import logging
import threading
from collections.abc import Mapping
from typing import Any

import zenoh

from actum import keys
from actum.runtime.credentials import check, client_values, login_values
from actum.settings import ServiceSettings, SettingsError

log = logging.getLogger("actum")

OPEN_TIMEOUT_MS = 500
"""How long one attempt to reach the router may take (ms)."""
RETRY_S = 0.2
"""Interval between two attempts (s)."""
ENCRYPTED = ("tls/", "quic/")
"""The beginnings of endpoints on which certificates are shown."""
LEASE_S = 10.0
"""Zenoh's default lease (s): how long the tokens of a silent session are kept."""

TRANSPORT = {
    "transport/shared_memory/enabled": False,
    "transport/link/tx/queue/size/data_high": 16,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 50_000,  # microseconds
    "transport/link/tx/queue/congestion_control/block/wait_before_close": 1_000_000,  # microseconds
}
"""Transport settings of all our sessions, of clients and router alike.

Shared memory loses messages silently when a reader is descheduled. With Zenoh's defaults, two batches and 1 ms, a
burst of thirty skeletons on a busy machine loses some: rather a put takes some milliseconds than a frame is lost.
A reader that is stopped stalls what the others read from the same sender until its link is closed, which by default
takes 5 s; when it goes on it connects anew, and recovers what it has missed.
"""

BEFORE_DROP = 2
"""Payloads longer than their key admits are counted by who decodes them, but those this many times as long never come:
Zenoh drops them before they wait in a ring, where a few hundred may wait. Only the gap in `seq` tells of them."""
CLIENT = {
    "mode": "client",
    "connect/timeout_ms": OPEN_TIMEOUT_MS,
    "connect/retry": {"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2},
    "listen/endpoints": [],
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "timestamping/enabled": True,  # late subscribers request messages by age
    "transport/link/rx/max_message_size": BEFORE_DROP * keys.MOST_IMAGE_BYTES,
    "low_pass_filter": [
        {
            "id": f"{size} bytes",
            "messages": ["put", "reply"],
            "flows": ["ingress"],
            "key_exprs": [keys.pattern(topic) for topic in keys.TOPICS if topic.max_bytes == size],
            "size_limit": BEFORE_DROP * size,
        }
        for size in sorted({topic.max_bytes for topic in keys.TOPICS})
    ],
    **TRANSPORT,
}
"""The configuration of all our clients but for the router's endpoint. Zenoh drops payloads that are far too large."""


class RouterUnreachableError(RuntimeError):
    """No router answered at the configured endpoint."""

    def __init__(self, endpoint: str) -> None:
        super().__init__(f"no router answers at {endpoint}: start one with 'actum router', or set ACTUM_CONNECT")


def client_config(settings: ServiceSettings) -> zenoh.Config:
    """Build a client's configuration: one router, and no discovery, which does not cross container networks.

    It names the files of the credentials and holds no secret.

    Raises:
        SettingsError: the configuration file that it extends, or the credentials, cannot be used.
    """
    try:
        config = zenoh.Config.from_file(settings.zenoh_config) if settings.zenoh_config else zenoh.Config()
    except zenoh.ZError as error:
        raise SettingsError(
            f"zenoh-config: {settings.zenoh_config} is not a valid Zenoh configuration ({reason_of(error)}): correct "
            "this file"
        ) from None
    insert(config, {**CLIENT, "connect/endpoints": [settings.connect]})
    if settings.credentials is not None:
        if not settings.connect.startswith(ENCRYPTED):
            raise SettingsError(
                f"credentials need TLS, but ACTUM_CONNECT is {settings.connect}: set ACTUM_CONNECT to tls/host:port"
            )
        check(settings.credentials)
        insert(config, client_values(settings.credentials))
    return config


def insert(config: zenoh.Config, values: Mapping[str, Any]) -> None:
    """Set values of a configuration by their paths."""
    for path, value in values.items():
        config.insert_json5(path, json.dumps(value))


def secret_config(settings: ServiceSettings) -> zenoh.Config:
    """Build the same with the user's name and password, where the credentials have these: to be opened, never shown.

    Raises:
        SettingsError: as `client_config`.
    """
    config = client_config(settings)
    if settings.credentials is not None:
        insert(config, login_values(settings.credentials))
    return config


def reason_of(error: zenoh.ZError) -> str:
    """Return the text of an error in one line, without the place in Zenoh's source that raised the error."""
    return " ".join(str(error).partition(" at /")[0].split())


def open_session(settings: ServiceSettings, stop: threading.Event) -> zenoh.Session | None:
    """Open a session, waiting for the router, which is logged once; None if stopped before."""
    config = secret_config(settings)
    waiting = False
    while not stop.is_set():
        try:
            session = zenoh.open(config)
        except zenoh.ZError:
            if not waiting:
                log.warning("there is no router at %s yet: waiting for a router", settings.connect)
            waiting = True
            stop.wait(RETRY_S)
            continue
        log.info("connected to %s", settings.connect)
        return session
    return None


def connected(session: zenoh.Session) -> bool:
    """Tell whether the session has a router now."""
    return bool(session.info.routers_zid())
