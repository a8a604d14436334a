"""What a router lets through of each message and of each key, by the table of topics."""

from collections.abc import Sequence
from typing import Any

from actum import keys
from actum.keys import BASE, TOPICS
from actum_deployer.access_control import ADVANCED
from actum_deployer.roles import IMAGES, ROLES

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


def message_limits(sensors: Sequence[str], ros_domain: int | None = None) -> dict[str, Any]:
    """Return the values of a router's configuration that limit size and rate of messages.

    Rates are limited where a message may be dropped for the next one. Zenoh limits the time between two messages of a
    connection, so that a limit on frames, marks or events would lose those that come at once after a link was cut.
    """
    largest = max(COMMAND_BYTES, *(topic.max_bytes for topic in TOPICS)) + ATTACHMENT_BYTES
    return {
        "transport/link/rx/max_message_size": largest,
        "low_pass_filter": [
            *(_size([keys.pattern(topic)], topic.max_bytes, topic.leaf) for topic in TOPICS),
            _size([f"{BASE}/**/{ADVANCED}"], HEARTBEAT_BYTES, "heartbeats"),
            _size([f"{BASE}/*/command/**"], COMMAND_BYTES, "commands"),
            *([] if ros_domain is None else [_size([f"{ros_domain}/**"], ROS_BYTES, "ROS 2")]),
        ],
        "downsampling": [
            {
                "id": "rates",
                "flows": ["ingress"],
                "messages": ["put"],
                "rules": [rule for sensor in sensors for rule in _rates(sensor)],
            }
        ],
    }


def _size(key_exprs: Sequence[str], limit: int, name: str) -> dict[str, Any]:
    return {
        "id": f"size of {name}",
        "flows": ["ingress"],
        "messages": ["put", "query", "reply"],
        "key_exprs": [*key_exprs],
        "size_limit": limit + ATTACHMENT_BYTES,
    }


def _rates(sensor: str) -> list[dict[str, Any]]:
    services = [service for role in ROLES for service in role.services]
    return [
        *({"key_expr": keys.key(topic, sensor), "freq": IMAGES_HZ} for topic in IMAGES),
        *({"key_expr": keys.key(keys.STATUS, sensor, service), "freq": STATUS_HZ} for service in services),
    ]
