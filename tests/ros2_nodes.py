"""Sessions as rmw_zenoh opens them, which know nothing of the bridge."""

import json
from collections.abc import Callable
from typing import Any

import zenoh

from live import wait_until
from ros2_bridge import message_types as types
from ros2_reading import read


def config(endpoint: str, mode: str = "peer", listen: str = "tcp/localhost:0") -> zenoh.Config:
    """What rmw_zenoh's own configuration of nodes, and of its router, comes to."""
    made = zenoh.Config()
    for path, value in {
        "mode": mode,
        "connect/endpoints": [endpoint],
        "listen/endpoints": [listen],
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": True,
        "timestamping/enabled": True,
    }.items():
        made.insert_json5(path, json.dumps(value))
    return made


class RosNode:
    """A session as that of a ROS 2 node, which reads all topics of domain 0."""

    def __init__(self, endpoint: str) -> None:
        self.session = zenoh.open(config(endpoint))
        self._received = self.session.declare_subscriber("0/**", zenoh.handlers.FifoChannel(10_000))
        self.samples: list[zenoh.Sample] = []

    def read(self, topic: str, type_name: str) -> list[Any]:
        """All messages so far of a topic."""
        while (sample := self._received.try_recv()) is not None:
            self.samples.append(sample)
        key = f"0/{topic}/{type_name.replace('/', '::', 1).replace('/', '::dds_::')}_/{types.type_hash(type_name)}"
        return [read(type_name, it.payload.to_bytes()) for it in self.samples if str(it.key_expr) == key]

    def put(self, key: str, *payloads: bytes) -> None:
        """Publish, once another session is known to listen: until then Zenoh drops what is put."""
        publisher = self.session.declare_publisher(key, allowed_destination=zenoh.Locality.REMOTE)
        wait_until(lambda: publisher.matching_status.matching, f"a subscriber to {key}")  # type: ignore[attr-defined]
        for payload in payloads:
            publisher.put(payload)
        publisher.undeclare()

    def wait_for(self, topic: str, type_name: str, wanted: Callable[[Any], bool] = bool) -> Any:
        def found() -> bool:
            return any(map(wanted, self.read(topic, type_name)))

        wait_until(found, f"a {type_name} on {topic}")
        return next(filter(wanted, self.read(topic, type_name)))

    def tokens(self) -> list[list[str]]:
        replies = self.session.liveliness().get("@ros2_lv/0/**", timeout=1.0)
        return sorted(str(reply.ok.key_expr).split("/") for reply in replies if reply.ok is not None)

    def topics(self) -> set[str]:
        """What `ros2 topic list` would say of the bridge, without its namespace."""
        return {token[9].removeprefix("%actum%kinect0%") for token in self.tokens() if len(token) > 9}
