"""ROS 2 messages read from their bytes by `mcap-ros2-support`, which shares no code with what wrote them."""

from functools import cache
from typing import Any

import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
dynamic = pytest.importorskip("mcap_ros2._dynamic", reason="mcap-ros2-support reads what the bridge writes")

from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402

from ros2_bridge.message_types import DEFINITIONS  # noqa: E402


@cache
def definition(type_name: str) -> str:
    """The text of a type's definition with those that it contains."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    return store.generate_msgdef(type_name, ros_version=2)[0]


@cache
def _decoder(type_name: str) -> Any:
    return dynamic.generate_dynamic(type_name, definition(type_name))[type_name]


def read(type_name: str, payload: bytes) -> Any:
    return _decoder(type_name)(payload)


def text(data: str) -> bytes:
    """A std_msgs/String, written by that other code."""
    encoder = dynamic.serialize_dynamic("std_msgs/msg/String", "string data")["std_msgs/msg/String"]
    return bytes(encoder({"data": data}))
