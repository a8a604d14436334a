"""Well-formed messages that cannot be true: counted by kind, answered as invalid where an answer is due, survived."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from actum import geometry
from actum.messages import Action, Image, Message, Objects, Posture, Segment, Skeleton
from actum.skeletons import INDEX, JOINTS
from node_cases import CLASSIFIER, FUSION, NOON_NS, PREPROCESSOR, TRACKER, Case, every_node, photograph
from people import FRAME_NS, STANDING
from wire import Wire

BEFORE_NS = NOON_NS - FRAME_NS

JPEG_OF_30000 = bytes.fromhex(
    "ffd8 ffe0 0010 4a46494600 0101 00 0001 0001 00 00 ffc0 000b 08 7530 7530 01 011100 ffda 0008 01 0100 003f00"
)
JPEG_OF_112 = JPEG_OF_30000.replace(b"\x75\x30", b"\x00\x70")
"""The headers of the photograph's size, without its pixels."""
MIRRORED = [-1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]


def changed(message: Message, **fields: Any) -> Message:
    return type(message).model_validate(message.model_dump() | {"stamp_ns": BEFORE_NS} | fields)


def first(case: Case, kind: type[Message]) -> Any:
    return next(message for message in case.messages() if isinstance(message, kind))


def moved(joints: Iterable[list[float] | None], name: str, joint: list[float] | None) -> list[list[float] | None]:
    listed = list(joints)
    listed[INDEX[name]] = joint
    return listed


def without(joints: Iterable[list[float] | None], *names: str) -> list[list[float] | None]:
    return [None if name in names else joint for name, joint in zip(JOINTS, joints, strict=True)]


def skeleton_with(joints: list[Any], times: int = 1) -> Message:
    agent = {"agent": 1, "joints": joints, "confidence": [1.0] * 15}
    return changed(first(PREPROCESSOR, Skeleton), agents=[agent] * times)


def posture_with(case: Case, **fields: Any) -> Message:
    return changed(first(case, Posture), **fields)


BAD_JOINTS: dict[str, list[float]] = {
    "NaN": [math.nan, 0.0, 2.0],
    "infinite": [0.0, -math.inf, 2.0],
    "2**31": [2.0**31, 0.0, 2.0],
    "-2**31": [0.0, 0.0, -(2.0**31)],
}


def bad_skeletons() -> dict[str, tuple[str, Message]]:
    standing = STANDING.tolist()
    odd_elbow = moved(standing, "left_elbow", BAD_JOINTS["NaN"])
    kinds = ("not_finite", "not_finite", "absurd_joint", "absurd_joint")
    bad = {
        f"{name} hand": (kind, skeleton_with(moved(standing, "left_hand", joint)))
        for kind, (name, joint) in zip(kinds, BAD_JOINTS.items(), strict=True)
    }
    return bad | {
        "no joint at all": ("missing_joint", skeleton_with([None] * 15)),
        "no torso": ("missing_joint", skeleton_with(moved(standing, "torso", None))),
        "no neck": ("missing_joint", skeleton_with(moved(standing, "neck", None))),
        "one hip, one shoulder": ("missing_joint", skeleton_with(without(standing, "left_hip", "right_shoulder"))),
        "NaN elbow, no hand": ("not_finite", skeleton_with(without(odd_elbow, "left_hand"))),
        "all joints in one place": ("coincident_joints", skeleton_with([[0.0, 0.0, 2.0]] * 15)),
        "a hand at its elbow": (
            "coincident_joints",
            skeleton_with(moved(standing, "left_hand", standing[INDEX["left_elbow"]])),
        ),
        "both hips in one place": (
            "coincident_joints",
            skeleton_with(moved(standing, "left_hip", standing[INDEX["right_hip"]])),
        ),
        "an arm of four metres": ("absurd_bone", skeleton_with(moved(standing, "left_hand", [0.3, 0.1, 6.0]))),
        "one agent twice": ("repeated_agent", skeleton_with(standing, times=2)),
        "invalid": ("invalid_skeleton", changed(first(PREPROCESSOR, Skeleton), valid=False, reason="r" * 1000)),
    }


def bad_postures_to_classify() -> dict[str, tuple[str, Message]]:
    posture = first(CLASSIFIER, Posture)
    bad = {
        f"{name} hand in {field}": (
            "bad_posture",
            posture_with(CLASSIFIER, **{field: moved(getattr(posture, field), "left_hand", joint)}),
        )
        for field in ("joints", "upright")
        for name, joint in BAD_JOINTS.items()
    }
    return bad | {
        "valid without joints": ("bad_posture", posture_with(CLASSIFIER, joints=None)),
        "valid without motion": ("bad_posture", posture_with(CLASSIFIER, motion=None)),
        "motion of 1e308 m": ("bad_posture", posture_with(CLASSIFIER, motion=[1e308] * 5)),
    }


def bad_marks() -> dict[str, tuple[str, Message]]:
    def mark(kind: str, **fields: Any) -> Message:
        return Segment.model_validate(
            {"stamp_ns": BEFORE_NS, "sensor": "kinect0", "kind": kind, "segment_id": "odd"} | fields
        )

    return {
        "end without start": ("rejected_segment", mark("end")),
        "end without start, centuries ahead": ("rejected_segment", mark("end", stamp_ns=2**62 - 1)),
        "end without stamp or start": ("rejected_segment", mark("end", stamp_ns=None)),
    }


def bad_images() -> dict[str, tuple[str, Message]]:
    foreign = {
        "K of zeros": {"K": [0.0] * 9},
        "K of 2**31": {"K": [2.0**31] * 9},
        "K with columns for rows": {"K": [100.0, 0.0, 0.0, 0.0, 100.0, 0.0, 56.0, 56.0, 1.0]},
        "K with a negative focal length": {"K": [100.0, 0.0, 56.0, 0.0, -100.0, 56.0, 0.0, 0.0, 1.0]},
        "distortion of 1e308": {"distortion": [1e308] * 5},
        "distortion of 2**31": {"distortion": [2.0**31, 0.0, 0.0, 0.0]},
        "distortion of 3 numbers": {"distortion": [0.1] * 3},
        "distortion of 70 numbers": {"distortion": [0.0] * 70},
        "extrinsics of zeros": {"skeleton_from_image": [0.0] * 16},
        "extrinsics out of the world": {
            "skeleton_from_image": [1.0, 0, 0, 1.7e308, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]
        },
        "extrinsics that mirror": {"skeleton_from_image": MIRRORED},
        "extrinsics that scale": {"skeleton_from_image": geometry.flat(np.diag([2.0, 2.0, 2.0, 1.0]))},
    }
    sizes = {"width": 30_000, "height": 30_000}
    return {
        name: ("bad_calibration", photograph(BEFORE_NS, **fields)) for name, fields in foreign.items()
    } | {
        "a JPEG header of 30,000 × 30,000": ("image_too_large", photograph(BEFORE_NS, data=JPEG_OF_30000)),
        "30,000 × 30,000 throughout": ("image_too_large", photograph(BEFORE_NS, data=JPEG_OF_30000, **sizes)),
        "raw, said to be 30,000 × 30,000": ("image_too_large", photograph(BEFORE_NS, format="bgr8", **sizes)),
        "raw, one byte short": ("image_size_mismatch", photograph(BEFORE_NS, format="bgr8", data=bytes(37631))),
        "raw, one byte long": ("image_size_mismatch", photograph(BEFORE_NS, format="bgr8", data=bytes(37633))),
        "black": ("black_image", photograph(BEFORE_NS, format="bgr8", data=bytes(37632))),
        "a JPEG of another size": ("image_size_mismatch", photograph(BEFORE_NS, width=113)),
        "a JPEG without pixels": ("undecodable_image", photograph(BEFORE_NS, data=JPEG_OF_112)),
        "a JPEG without a size": ("undecodable_image", photograph(BEFORE_NS, data=b"\xff\xd8\xff\xe0\x00\x04ab")),
        "a PNG": ("undecodable_image", photograph(BEFORE_NS, data=b"\x89PNG\r\n\x1a\n" + bytes(100))),
        "half a JPEG's header": ("undecodable_image", photograph(BEFORE_NS, data=JPEG_OF_30000[:12])),
        "no data": ("undecodable_image", photograph(BEFORE_NS, data=b"")),
    }  # fmt: skip


def bad_input_to_fusion() -> dict[str, tuple[str, Message]]:
    joints = first(FUSION, Posture).joints_m
    bad = {
        f"{name} hand": ("bad_joint", posture_with(FUSION, joints_m=moved(joints, "right_hand", joint)))
        for name, joint in BAD_JOINTS.items()
    }
    frames = {
        **{f"of {number:g}": [number] * 16 for number in (0.0, 2.0**31, 1e308)},
        "that mirrors": MIRRORED,
        "of a projection": [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 1.0, 0],
    }
    action = first(FUSION, Action)
    far = [found.model_dump() | {"position_m": [2.0**31, 0.0, 0.0]} for found in first(FUSION, Objects).objects]
    return bad | {
        "valid without joints": ("bad_posture", posture_with(FUSION, joints_m=None)),
        "valid without a frame": ("bad_posture", posture_with(FUSION, ego_from_camera=None)),
        **{
            f"a frame {name}": ("bad_posture", posture_with(FUSION, ego_from_camera=frame))
            for name, frame in frames.items()
        },
        "objects 2**31 m away": ("bad_object", changed(first(FUSION, Objects), objects=far)),
        "final without label": ("bad_action", changed(action, action=None, segment_id="odd")),
        "final without end": ("bad_action", changed(action, end_ns=None, segment_id="odd")),
        "end before start": ("bad_action", changed(action, end_ns=0, segment_id="odd")),
    }


BAD: dict[Case, dict[str, tuple[str, Message]]] = {
    PREPROCESSOR: bad_skeletons(),
    CLASSIFIER: bad_postures_to_classify() | bad_marks(),
    TRACKER: bad_images(),
    FUSION: bad_input_to_fusion(),
}
LASTING = {"stamp_ns", "valid", "joints", "action", "frames", "activations", "objects", "object", "sentence"}
"""What of an answer does not depend on the frame just before."""

each_bad_message = pytest.mark.parametrize(
    ("case", "kind", "message"),
    [pytest.param(case, *told, id=f"{case}: {name}") for case, bad in BAD.items() for name, told in bad.items()],
)


@each_bad_message
def test_it_is_counted_by_kind(case: Case, kind: str, message: Message) -> None:
    wire = Wire(case.build())
    wire.send(message)
    assert wire.node.counters.rejects[kind] >= 1
    assert set(wire.node.counters.rejects) == {kind}
    assert kind in (wire.node.counters.last_error or "")


@each_bad_message
def test_no_answer_passes_for_a_good_one(case: Case, kind: str, message: Message) -> None:
    outputs = Wire(case.build()).send(message)
    assert kind == "repeated_agent" or not any(output.valid for output in outputs)
    assert len(outputs) == (1 if isinstance(message, Skeleton | Image | Segment | Action) else 0)
    for output in outputs:
        if message.valid and not output.valid and isinstance(output, Posture | Objects):
            assert kind in (output.reason or "")
            assert not (output.joints if isinstance(output, Posture) else output.objects)


@every_node
def test_the_task_right_after_all_of_them_is_answered(case: Case) -> None:
    def answers(wire: Wire) -> list[dict[str, Any]]:
        told = [answer for answer in wire.send(*case.messages()) if case.wanted(answer, "task")]
        return [answer.model_dump(include=LASTING) for answer in told]

    wire = Wire(case.build())
    for i, (_, message) in enumerate(BAD[case].values()):
        wire.send(message.model_copy(update={"stamp_ns": NOON_NS - (len(BAD[case]) - i) * FRAME_NS}))
    assert answers(wire) == answers(Wire(case.build()))
