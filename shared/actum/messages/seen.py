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
    """The person's number, from 1; it stays the same from frame to frame."""
    joints: Joints
    """The fifteen joints in the order of `info.joint_names`, metres, camera frame; null for a missing joint."""
    confidence: Annotated[list[float], Field(min_length=15, max_length=15)]
    """The source's confidence in each joint, 0 to 1, in the order of `joints`."""
    depth_std_m: Deviation | None = None
    """Standard deviation (m) of the person's distance along the line of sight, relative to everything else in the
    image, if the source infers this distance from the body's size; null if the distance is measured."""


class Skeleton(Message):
    """All agents of one captured frame, camera frame."""

    SCHEMA = "actum.skeleton"
    agents: Annotated[list[Agent], Field(max_length=MOST_AGENTS)]
    """All people in the frame; empty if nobody is there."""
    up_in_camera: Direction | None = None
    """A vector that points up, against gravity, in the camera frame; null if the camera counts as level, [0, -1, 0]."""
    session_id: Name = ""
    """The run of the source; if it changes, stamps and agents' numbers begin anew."""


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
    """The lens's distortion coefficients in OpenCV's order; empty without distortion."""
    skeleton_from_image: Transform
    """Maps points of this camera's frame to the frame of the skeletons: 4x4, row-major, metres."""
    intrinsics_assumed: bool = False
    """Whether `K` follows from an assumed field of view, which nobody has measured."""
    session_id: Name = ""
    """The run of the source, as in the skeleton."""


class Posture(Message):
    """One agent's posture, egocentric (x left, y up, z forward); a joint that the source lacks is null."""

    SCHEMA = "actum.posture"
    agent: AgentId
    """The person's number; 0 if unidentified."""
    joints_m: Joints | None
    """The measured joints in metres, egocentric (x left, y up, z forward, origin on the hip line); null for a missing
    joint. If torso or neck is missing for a moment, its last place is used, moved along with the body."""
    joints: Joints | None
    """The same posture with standard bone lengths. A joint is null if it is missing, or if a joint between it and the
    torso is missing."""
    upright: Joints | None = None
    """`joints` relative to the torso, with y up along gravity, z horizontal, and the heading smoothed over a second."""
    ego_from_camera: Transform | None
    """Maps points of the camera frame to the egocentric frame of `joints_m`: 4x4, row-major, metres."""
    motion: Annotated[list[FiniteFloat], Field(min_length=5, max_length=5)] | None
    """Displacement (m) of right arm, left arm, right leg, left leg and body since the last valid frame: the mean over
    the part's joints, relative to the torso and low-passed; 0 for a part without known joints."""
    frame: Name = "egocentric"
    """`egocentric`, or `world` if the axes are not those of the person's body."""
    depth_std_m: Deviation | None = None
    """The agent's `depth_std_m` in the skeleton (m)."""
    up_in_camera: Direction | None = None
    """The skeleton's `up_in_camera`."""
    agents: Annotated[list[AgentId], Field(max_length=MOST_AGENTS)] = Field([])
    """The numbers of all agents of the captured frame."""
    previous_ns: Stamp | None = None
    """The stamp of the previous captured frame (ns). The postures of that frame may be on other agents' keys."""
    missed: Seq = 0
    """Number of frames lost between the previous frame and this one."""
    session_id: Name = ""
    """The run of the source, as in the skeleton."""


class TrackedObject(Model):
    """One object's pose in the skeleton's camera frame."""

    id: Annotated[int, Field(ge=0, lt=2**31)]
    """The object's number: the number of its marker, or the number in the scene file."""
    name: Name
    """The object's name."""
    position_m: FinitePoint
    """The position of the object's centre: metres, camera frame of the skeletons."""
    quaternion_xyzw: Quaternion
    """The rotation from the object's own axes to those of the camera frame, as a unit quaternion."""
    confidence: FiniteFloat
    """The tracker's confidence in the pose, 0 to 1."""
    seen: bool
    """Whether the object was seen in this image; if not, its pose is remembered."""
    velocity_mps: FinitePoint | None = None
    """The object's velocity in the camera frame (m/s); null if unknown."""
    predicted: bool = False
    """For an object that is not seen: whether its place was extrapolated with its velocity. If neither `predicted` nor
    `followed`, the place is the one last expected."""
    followed: bool = False
    """For an object that is not seen: whether its place was found by following, in the image, what covers the
    object."""


class Objects(Message):
    """All objects of one image."""

    SCHEMA = "actum.objects"
    objects: Annotated[list[TrackedObject], Field(max_length=MOST_OBJECTS)]
    """All objects that are seen, followed or remembered."""
    session_id: Name = ""
    """The run of the source, as in the image."""
