"""Bodies as a ROS4HRI detector publishes them, written by `mcap-ros2-support`, which shares no code with the bridge."""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from actum.bridge import Foreign
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from ros2_reading import definition, dynamic

Array = NDArray[np.float64]
pytest.importorskip("rosbags", reason="the bridge needs it")

from ros2_bridge import message_types as types  # noqa: E402
from ros2_bridge import topics  # noqa: E402
from ros2_bridge.hri import types as hri  # noqa: E402

OPTICAL = "camera_optical_frame"
NOT_TURNED = (0.0, 0.0, 0.0, 1.0)
MODEL_FRAMES = {
    "head": "head", "torso": "neck",
    "l_shoulder": "left_shoulder", "l_elbow": "left_elbow", "l_wrist": "left_hand",
    "r_shoulder": "right_shoulder", "r_elbow": "right_elbow", "r_wrist": "right_hand",
    "l_hip": "left_hip", "l_knee": "left_knee", "l_ankle": "left_foot",
    "r_hip": "right_hip", "r_knee": "right_knee", "r_ankle": "right_foot",
}  # fmt: skip
"""Our joint at the origin of each frame of human_description."""
Transform = dict[str, Any]


@cache
def _encoder(type_name: str) -> Any:
    return dynamic.serialize_dynamic(type_name, definition(type_name))[type_name]


def written(type_name: str, fields: Mapping[str, Any]) -> bytes:
    return bytes(_encoder(type_name)(fields))


def header(stamp_ns: int, frame_id: str = OPTICAL) -> dict[str, Any]:
    sec, nanosec = divmod(stamp_ns, SECOND_NS)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}


def transform(
    stamp_ns: int,
    child: str,
    at_m: Sequence[float] | Array,
    xyzw: Sequence[float] = NOT_TURNED,
    parent: str = OPTICAL,
) -> Transform:
    translation = dict(zip("xyz", map(float, at_m), strict=True))
    rotation = dict(zip("xyzw", map(float, xyzw), strict=True))
    placed = {"translation": translation, "rotation": rotation}
    return {"header": header(stamp_ns, parent), "child_frame_id": child, "transform": placed}


def frames(stamp_ns: int, joints: Array, body_id: str, names: Mapping[str, str] = MODEL_FRAMES) -> list[Transform]:
    """A frame at each known joint, straight below the camera's; `names` gives the joint of each name."""
    placed = {name: joints[INDEX[joint]] for name, joint in names.items()}
    return [
        transform(stamp_ns, f"{name}_{body_id}", joint) for name, joint in placed.items() if not np.isnan(joint).any()
    ]


def tf(*transforms: Transform) -> Foreign:
    payload = written(types.TF_MESSAGE, {"transforms": list(transforms)})
    return Foreign(topics.OTHERS_TF.name, payload, "0/tf/type/hash")


def tf_static(*transforms: Transform) -> Foreign:
    payload = written(types.TF_MESSAGE, {"transforms": list(transforms)})
    return Foreign(topics.OTHERS_TF_STATIC.name, payload, "0/tf_static/type/hash")


def tracked(stamp_ns: int, *ids: str) -> Foreign:
    payload = written(hri.IDS_LIST, {"header": header(stamp_ns), "ids": list(ids)})
    return Foreign(topics.OTHERS_TRACKED.name, payload, "0/humans/bodies/tracked/type/hash")


def joint_states(stamp_ns: int, body_id: str, angles_rad: Mapping[str, float]) -> Foreign:
    fields = {
        "header": header(stamp_ns),
        "name": [f"{name}_{body_id}" for name in angles_rad],
        "position": list(angles_rad.values()),
        "velocity": [],
        "effort": [],
    }
    key = f"0/humans/bodies/{body_id}/joint_states/type/hash"
    return Foreign(topics.OTHERS_JOINT_STATES.name, written(hri.JOINT_STATE, fields), key)


def urdf(body_id: str, text: str) -> Foreign:
    key = f"0/humans/bodies/{body_id}/urdf/type/hash"
    return Foreign(topics.OTHERS_URDF.name, written(types.STRING, {"data": text}), key)


def skeleton_2d(stamp_ns: int, body_id: str) -> Foreign:
    point = {"x": 0.5, "y": 0.5, "c": 0.9}
    payload = written(hri.SKELETON_2D, {"header": header(stamp_ns), "skeleton": [point] * 18})
    return Foreign(topics.OTHERS_SKELETON_2D.name, payload, f"0/humans/bodies/{body_id}/skeleton2d/type/hash")


def one_frame(stamp_ns: int, people: Mapping[str, Array]) -> Iterable[Foreign]:
    """All that a detector puts about an image."""
    yield tracked(stamp_ns, *people)
    yield tf(*(each for body_id, joints in people.items() for each in frames(stamp_ns, joints, body_id)))
