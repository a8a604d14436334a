"""The ROS 2 message types that the bridge needs: their definitions, hashes, default values, and their bytes (CDR)."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from ros2_bridge.hri import types as hri

STRING = "std_msgs/msg/String"
MARKER_ARRAY = "visualization_msgs/msg/MarkerArray"
TF_MESSAGE = "tf2_msgs/msg/TFMessage"
DETECTION_3D_ARRAY = "vision_msgs/msg/Detection3DArray"
ACTION_EVENT = "actum_msgs/msg/ActionEvent"
ACTION_INTENT = "actum_msgs/msg/ActionIntent"
INTENDED_CONTACT = "actum_msgs/msg/IntendedContact"
PERSON_ACTION = "actum_msgs/msg/PersonAction"

OWN = (ACTION_EVENT, INTENDED_CONTACT, ACTION_INTENT, PERSON_ACTION)
"""Our own types, whose definitions are files of the package `actum_msgs`."""

DEFINITIONS = {
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score",
    "vision_msgs/msg/ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
    "vision_msgs/msg/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
    "vision_msgs/msg/Detection3D": "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox3D bbox\n"
    "string id",
    DETECTION_3D_ARRAY: "std_msgs/Header header\nDetection3D[] detections",
    **hri.DEFINITIONS,
    **{name: (Path(__file__).parent / f"{name}.msg").read_text(encoding="utf-8") for name in OWN},
}
"""What `rosbags` lacks: those of vision_msgs 4, of Humble and later, of ROS4HRI, and our own."""

_ZERO: dict[str, Any] = {"string": "", "bool": False}
"""The default values of primitive types that are not numbers."""


class NotThatTypeError(ValueError):
    """Bytes that are no message of the type."""


@cache
def _store() -> Any:
    """Return the types of Jazzy, of which those that the bridge needs are the same in Humble and Kilted."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    return store


def type_hash(name: str) -> str:
    """Return a type's hash as it stands in rmw_zenoh's keys: `RIHS01_…`."""
    return str(_store().hash_rihs01(name))


def made(name: str, /, **fields: Any) -> Any:
    """Make a message of the type; fields that are not given have ROS's default values."""
    kind, defaults = _kind_and_defaults(name)
    return kind(**(defaults | fields))


def to_cdr(message: Any) -> bytes:
    """Return a message's bytes."""
    return bytes(_store().serialize_cdr(message, message.__msgtype__, little_endian=True))


def from_cdr(payload: bytes, name: str) -> Any:
    """Return the message of a type that bytes hold.

    Raises:
        NotThatTypeError: they hold none.
    """
    try:
        return _store().deserialize_cdr(payload, name)
    except SerdeError as error:
        raise NotThatTypeError(str(error)) from None


@cache
def _kind_and_defaults(name: str) -> tuple[Any, dict[str, Any]]:
    """Return the class of a type's messages and its default values; `dataclasses.replace` would take twice as long."""
    default = _default(name)
    return type(default), vars(default)


@cache
def _default(name: str) -> Any:
    """Make the message of a type in which nothing is set, which is shared and not to be changed."""
    if name == "geometry_msgs/msg/Quaternion":
        return _store().types[name](x=0.0, y=0.0, z=0.0, w=1.0)
    return _store().types[name](
        **{field: _default_of(*description) for field, description in _store().fielddefs[name][1]}
    )


def _default_of(kind: Nodetype, description: Any) -> Any:
    """Return the default value of a field: a primitive, a message, or a sequence or array of either."""
    match kind:
        case Nodetype.BASE:
            primitive = description[0]
            return _ZERO.get(primitive, 0.0 if primitive.startswith("float") else 0)
        case Nodetype.NAME:
            return _default(description)
    (element, of), length = description
    if element is Nodetype.NAME or of[0] == "string":
        return [_default_of(element, of)] * length
    return np.zeros(length, dtype=of[0])
