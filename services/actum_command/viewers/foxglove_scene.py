"""People and objects as Foxglove draws them, and the frames in which they lie."""

from collections.abc import Sequence

import numpy as np
from foxglove.messages import (
    Color,
    FrameTransform,
    LinePrimitive,
    LinePrimitiveLineType,
    Point3,
    Pose,
    Quaternion,
    SceneEntity,
    SceneEntityDeletion,
    SceneEntityDeletionType,
    SpherePrimitive,
    TextPrimitive,
    Timestamp,
    Vector3,
)

from actum.geometry import quaternion_xyzw, untilted_from_camera
from actum.messages import Agent, Image, Message, Objects, Point, Skeleton, TrackedObject
from actum.node import SECOND_NS
from actum_command.viewers.contents import AXIS_M, BONE_M, JOINT_M, TRUNK, Rgb, figure

LEVEL_CAMERA = (0.0, -1.0, 0.0)
"""Where up is in the frame of a camera that does not say it."""
Z_UP_FROM_UNTILTED = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""From right, down, forward to forward, left, up: (3, 3)."""
ORIGIN: Point = [0.0, 0.0, 0.0]
"""Where a frame begins."""
UNTURNED = [0.0, 0.0, 0.0, 1.0]
"""The quaternion x, y, z, w of no rotation."""
FONT_M = 0.08
"""Height (m) of names in space: a hand's breadth."""
AXES: tuple[tuple[Point, Rgb], ...] = (
    ([AXIS_M, 0.0, 0.0], (220, 60, 50)),
    ([0.0, AXIS_M, 0.0], (60, 170, 70)),
    ([0.0, 0.0, AXIS_M], (60, 100, 220)),
)
"""The ends of an object's axes (m) with their colours: x red, y green, z blue."""
LATEST_NS = 2**32 * SECOND_NS - 1
"""Foxglove counts seconds in 32 bits: the last stamp (ns) that it has a number for."""


def time_of(message: Message) -> Timestamp:
    """Return a message's stamp as Foxglove writes it, or the latest that it can write."""
    stamp_ns = min(message.stamp_ns, LATEST_NS)
    return Timestamp(sec=stamp_ns // SECOND_NS, nsec=stamp_ns % SECOND_NS)


def z_up(skeleton: Skeleton) -> FrameTransform:
    """Place the camera's frame in one with z against gravity and x forward, as Foxglove looks at space."""
    untilted = untilted_from_camera(skeleton.up_in_camera or LEVEL_CAMERA)
    turned = quaternion_xyzw(Z_UP_FROM_UNTILTED @ untilted)
    return _transform(skeleton, f"{skeleton.sensor}/z_up", skeleton.sensor, ORIGIN, turned)


def of_image(image: Image, frame: str) -> FrameTransform:
    """Place an image's frame in the camera's frame of the skeletons."""
    skeleton_from_image = np.reshape(image.skeleton_from_image, (4, 4))
    shift_m = skeleton_from_image[:3, 3].tolist()
    return _transform(image, image.sensor, frame, shift_m, quaternion_xyzw(skeleton_from_image[:3, :3]))


def of_object(objects: Objects, tracked: TrackedObject) -> FrameTransform:
    """Place an object's frame in the camera's."""
    frame = _object_frame(objects, tracked)
    return _transform(objects, objects.sensor, frame, tracked.position_m, tracked.quaternion_xyzw)


def person(skeleton: Skeleton, agent: Agent) -> SceneEntity:
    """Draw a person's bones and joints in the camera's frame, with the number at the first joint that is known."""
    drawn, name = figure(agent), f"agent {agent.agent}"
    size = _vector3([2 * JOINT_M] * 3)
    joints = [
        SpherePrimitive(pose=_pose(joint), size=size, color=_colour(colour))
        for joint, colour in zip(drawn.joints, drawn.joint_colours, strict=True)
    ]
    return SceneEntity(
        timestamp=time_of(skeleton),
        frame_id=skeleton.sensor,
        id=name,
        lines=[_lines(drawn.bones, drawn.bone_colours, 2 * BONE_M)],
        spheres=joints,
        texts=[_text(name, joint) for joint in drawn.joints[:1]],
    )


def thing(objects: Objects, tracked: TrackedObject) -> SceneEntity:
    """Draw an object's name and axes in its own frame."""
    axes = [(ORIGIN, end) for end, _ in AXES]
    return SceneEntity(
        timestamp=time_of(objects),
        frame_id=_object_frame(objects, tracked),
        id=f"object {tracked.id}",
        lines=[_lines(axes, [colour for _, colour in AXES], BONE_M)],
        texts=[_text(tracked.name if tracked.seen else f"{tracked.name} (not seen)", ORIGIN)],
    )


def deleted(message: Message, name: str) -> SceneEntityDeletion:
    """Take a person or an object out of the scene."""
    return SceneEntityDeletion(timestamp=time_of(message), type=SceneEntityDeletionType.MatchingId, id=name)


def _object_frame(objects: Objects, tracked: TrackedObject) -> str:
    return f"{objects.sensor}/object/{tracked.id}"


def _transform(message: Message, parent: str, child: str, shift_m: Point, xyzw: list[float]) -> FrameTransform:
    """Return what maps points of the child's frame to the parent's."""
    return FrameTransform(
        timestamp=time_of(message),
        parent_frame_id=parent,
        child_frame_id=child,
        translation=_vector3(shift_m),
        rotation=_quaternion(xyzw),
    )


def _lines(segments: Sequence[tuple[Point, Point]], colours: Sequence[Rgb], thickness_m: float) -> LinePrimitive:
    """Return separate lines, each with its two ends in its colour."""
    return LinePrimitive(
        type=LinePrimitiveLineType.LineList,
        pose=_pose(ORIGIN),
        thickness=thickness_m,
        points=[Point3(x=x, y=y, z=z) for segment in segments for x, y, z in segment],
        colors=[_colour(colour) for colour in colours for _ in range(2)],
    )


def _text(text: str, place: Point) -> TextPrimitive:
    return TextPrimitive(pose=_pose(place), billboard=True, font_size=FONT_M, color=_colour(TRUNK), text=text)


def _pose(place: Point) -> Pose:
    return Pose(position=_vector3(place), orientation=_quaternion(UNTURNED))


def _vector3(xyz: Point) -> Vector3:
    x, y, z = xyz
    return Vector3(x=x, y=y, z=z)


def _quaternion(xyzw: list[float]) -> Quaternion:
    x, y, z, w = xyzw
    return Quaternion(x=x, y=y, z=z, w=w)


def _colour(rgb: Rgb) -> Color:
    red, green, blue = (level / 255 for level in rgb)
    return Color(r=red, g=green, b=blue, a=1.0)
