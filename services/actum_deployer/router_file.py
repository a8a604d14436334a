"""The configuration of a host's router, a JSON5 file that `actum router --config` and Eclipse's zenohd read."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from actum import keys
from actum.keys import BASE, TOPICS
from actum.runtime.credentials import router_values
from actum.runtime.session import TRANSPORT
from actum_deployer.access_control import ADVANCED, access_control
from actum_deployer.credential_folders import CREDENTIALS
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import Host
from actum_deployer.programs import INSTALLED
from actum_deployer.roles import IMAGES, ROLES, ROUTER

ATTACHMENT_BYTES = 1000
"""Room for what comes with a payload: a list of three numbers and a name takes some tens."""
HEARTBEAT_BYTES = 1000
"""Largest message on a key with `@adv`: a heartbeat is a number."""
COMMAND_BYTES = 16_000_000
"""Largest command and reply: a video is taught from in parts of half a megabyte, a film of an example takes some."""
ROS_BYTES = 4_000_000
"""Largest message on ROS 2's keys: the markers of 64 people take some hundred kilobytes."""
IMAGES_HZ = 120
"""Most images a second of one sensor: twice the fastest camera's. Only the newest counts, so others may be dropped."""
STATUS_HZ = 20
"""Most reports a second of one service, which puts one; a report that is dropped is followed by another."""
MOST_SESSIONS = 128
"""Most clients and routers at a time: some tens are in use, and each takes memory."""
RETRY = {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2}
"""How often a router tries to reach another (ms): a link that is back is used within a second."""


def router_file(deployment: Deployment, host: Host) -> str:
    """Return the text of the file."""
    about = (
        f"// The router of {host.name}, written by 'actum deploy init': change the arguments of that command, not "
        "this file.\n"
    )
    return about + json.dumps(_nested(_configuration(deployment, host)), indent=1) + "\n"


def _configuration(deployment: Deployment, host: Host) -> dict[str, Any]:
    """Return the values of Zenoh's configuration by their paths."""
    earlier = deployment.routers[: deployment.routers.index(host)]
    transport = deployment.transport
    values = {
        "mode": "router",
        "listen/endpoints": [f"{transport}/0.0.0.0:{host.port}"],
        "connect/endpoints": [f"{transport}/{each.endpoint}" for each in earlier],
        "connect/retry": RETRY,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "adminspace": {"enabled": True, "permissions": {"read": True, "write": False}},
        **TRANSPORT,
        "transport/link/protocols": [transport],
        "transport/unicast/max_sessions": MOST_SESSIONS,
        **_message_limits(deployment),
    }
    if not deployment.secured:
        return values
    files = router_values(Path(INSTALLED) / CREDENTIALS / ROUTER, deployment.passwords)
    return {**values, **files, "access_control": access_control(deployment)}


def _message_limits(deployment: Deployment) -> dict[str, Any]:
    """Return the values of a router's configuration that limit size and rate of messages.

    Rates are limited where a message may be dropped for the next one. Zenoh limits the time between two messages of a
    connection, so that a limit on frames, marks or events would lose those that come at once after a link was cut.
    """
    largest = max(COMMAND_BYTES, *(topic.max_bytes for topic in TOPICS)) + ATTACHMENT_BYTES
    ros = [] if deployment.ros_domain is None else [_size(f"{deployment.ros_domain}/**", ROS_BYTES, "ROS 2")]
    services = [service for role in ROLES for service in role.services]
    rates: list[dict[str, Any]] = []
    for sensor in deployment.sensors:
        rates += [{"key_expr": keys.key(topic, sensor), "freq": IMAGES_HZ} for topic in IMAGES]
        rates += [{"key_expr": keys.key(keys.STATUS, sensor, service), "freq": STATUS_HZ} for service in services]
    return {
        "transport/link/rx/max_message_size": largest,
        "low_pass_filter": [
            *(_size(keys.pattern(topic), topic.max_bytes, topic.leaf) for topic in TOPICS),
            _size(f"{BASE}/**/{ADVANCED}", HEARTBEAT_BYTES, "heartbeats"),
            _size(f"{BASE}/*/command/**", COMMAND_BYTES, "commands"),
            *ros,
        ],
        "downsampling": [{"id": "rates", "flows": ["ingress"], "messages": ["put"], "rules": rates}],
    }


def _size(key_expr: str, limit: int, name: str) -> dict[str, Any]:
    return {
        "id": f"size of {name}",
        "flows": ["ingress"],
        "messages": ["put", "query", "reply"],
        "key_exprs": [key_expr],
        "size_limit": limit + ATTACHMENT_BYTES,
    }


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by paths as sections within sections."""
    nested: dict[str, Any] = {}
    for path, value in values.items():
        section = nested
        *sections, name = path.split("/")
        for each in sections:
            section = section.setdefault(each, {})
        section[name] = value
    return nested
