"""Messages of sensors, preprocessor and tracker: images, skeletons, postures, objects."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import (
    LARGEST_SIDE_PX,
    MOST_AGENTS,
    MOST_OBJECTS,
    AgentId,
    Deviation,
    Direction,
    FinitePoint,
    Intrinsics,
    Joints,
    Message,
    Model,
    Name,
    Quaternion,
    Seq,
    Stamp,
    Transform,
)


class Agent(Model):
    """One tracked person of a skeleton frame."""

    agent: Annotated[int, Field(ge=1, lt=2**31)]
    """The person's number, from 1, the same from frame to frame."""
    joints: Joints
    """The fifteen joints in the order of `info.joint_names`, metres, camera frame; null where one is missing."""
    confidence: Annotated[list[float], Field(min_length=15, max_length=15)]
    """How sure the source is of each joint, 0 to 1, in the same order."""
    depth_std_m: Deviation | None = None
    """Standard deviation (m) of the whole body's distance along the line of sight, where the source infers
    that from the body's size, beside that of all else in the image; null where it is measured."""


class Skeleton(Message):
    """All agents of one captured frame, camera frame."""

    SCHEMA = "actum.skeleton"
    agents: Annotated[list[Agent], Field(max_length=MOST_AGENTS)]
    """Everybody in the frame; empty where nobody is there."""
    up_in_camera: Direction | None = None
    """A vector against gravity in the camera frame; null where the camera is taken for level, [0, -1, 0]."""
    session_id: Name = ""
    """The run of the source; another one means that its stamps and agents' numbers began anew."""


class Image(Message):
    """A colour or depth image with its camera."""

    SCHEMA = "actum.image"
    format: Literal["jpeg", "bgr8", "depth16_mm"]
    """How `data` is written: `jpeg`, `bgr8` (rows of blue, green, red bytes), or `depth16_mm` (rows of little-endian
    16-bit millimetres, 0 where unknown)."""
    width: Annotated[int, Field(gt=0, le=LARGEST_SIDE_PX)]
    """Columns (px)."""
    height: Annotated[int, Field(gt=0, le=LARGEST_SIDE_PX)]
    """Rows (px)."""
    data: bytes
    """The picture's bytes."""
    K: Intrinsics
    """The camera matrix 3x3, row-major (px)."""
    distortion: list[FiniteFloat]
    """The lens's distortion in OpenCV's order; empty where there is none."""
    skeleton_from_image: Transform
    """Maps points of this camera's frame to the frame of the skeletons: 4x4, row-major, metres."""
    intrinsics_assumed: bool = False
    """Whether `K` follows from a field of view that nobody has measured."""
    session_id: Name = ""
    """The run of the source, as the skeleton's."""


class Posture(Message):
    """One agent's posture, egocentric (x left, y up, z forward); a joint that the source lacks is null."""

    SCHEMA = "actum.posture"
    agent: AgentId
    """The person's number; 0 where nobody is sure who it is."""
    joints_m: Joints | None
    """The measured joints in metres, egocentric (x left, y up, z forward, origin on the hip line); null where one is
    missing. Torso and neck may be those of a moment before, moved on with the body."""
    joints: Joints | None
    """The same posture with standard bone lengths; a joint is null also where one on its way from the torso is."""
    upright: Joints | None = None
    """`joints` relative to the torso, with y up along gravity, z horizontal, and the heading smoothed over a second."""
    ego_from_camera: Transform | None
    """Maps points of the camera frame to the egocentric frame of `joints_m`: 4x4, row-major, metres."""
    motion: Annotated[list[FiniteFloat], Field(min_length=5, max_length=5)] | None
    """Mean displacement (m) since the last valid frame of right arm, left arm, right leg, left leg and body, relative
    to the torso and low-passed; 0 for a part of which no joint is known."""
    frame: Name = "egocentric"
    """`egocentric`, or `world` where the frame is no body's, so that its forward is nobody's."""
    depth_std_m: Deviation | None = None
    """The agent's `depth_std_m` of the skeleton (m)."""
    up_in_camera: Direction | None = None
    """The skeleton's `up_in_camera`."""
    agents: Annotated[list[AgentId], Field(max_length=MOST_AGENTS)] = Field([])
    """The numbers of all agents of the captured frame."""
    previous_ns: Stamp | None = None
    """The stamp of the captured frame before this one, whose postures may be on other agents' keys (ns)."""
    missed: Seq = 0
    """How many frames were lost just before this one."""
    session_id: Name = ""
    """The run of the source, as the skeleton's."""


class TrackedObject(Model):
    """One object's pose in the skeleton's camera frame."""

    id: Annotated[int, Field(ge=0, lt=2**31)]
    """The object's number: its marker's, or that of the scene file."""
    name: Name
    """What it is called."""
    position_m: FinitePoint
    """Where its middle is: metres, camera frame of the skeletons."""
    quaternion_xyzw: Quaternion
    """The rotation from its own axes to the camera frame's, as a unit quaternion."""
    confidence: FiniteFloat
    """How sure the tracker is of the pose, 0 to 1."""
    seen: bool
    """Whether it was seen in this image; if not, it is remembered."""
    velocity_mps: FinitePoint | None = None
    """Its velocity in the camera frame (m/s); null where it is not known."""
    predicted: bool = False
    """Of an object that is not seen: whether its place was carried on with its velocity. If neither this nor
    `followed`, it is listed where it was expected last."""
    followed: bool = False
    """Of an object that is not seen: whether its place is that of what covers it, followed in the image."""


class Objects(Message):
    """All objects of one image."""

    SCHEMA = "actum.objects"
    objects: Annotated[list[TrackedObject], Field(max_length=MOST_OBJECTS)]
    """All that are seen, followed or remembered."""
    session_id: Name = ""
    """The run of the source, as the image's."""
