"""What sources and trackers tell: images, people, postures, objects."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import (
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
    """One tracked person of a skeleton frame.

    `depth_std_m` is the standard deviation of the whole body's distance along the line of sight, where the source
    infers that from the body's size, beside that of all else in the image; null where it is measured.
    """

    agent: Annotated[int, Field(ge=1, lt=2**31)]
    joints: Joints
    confidence: Annotated[list[float], Field(min_length=15, max_length=15)]
    depth_std_m: Deviation | None = None


class Skeleton(Message):
    """All agents of one captured frame, camera frame; `agents` is empty when nobody is there.

    `up_in_camera` points against gravity; null where the camera is taken for level, [0, -1, 0].
    """

    SCHEMA = "actum.skeleton"
    agents: Annotated[list[Agent], Field(max_length=MOST_AGENTS)]
    up_in_camera: Direction | None = None
    session_id: Name = ""


class Image(Message):
    """A colour (`jpeg`, `bgr8`) or depth (`depth16_mm`, little-endian) image with its camera.

    `intrinsics_assumed` tells that `K` follows from a field of view that nobody has measured.
    """

    SCHEMA = "actum.image"
    format: Literal["jpeg", "bgr8", "depth16_mm"]
    width: Annotated[int, Field(gt=0)]
    height: Annotated[int, Field(gt=0)]
    data: bytes
    K: Intrinsics
    distortion: list[FiniteFloat]
    skeleton_from_image: Transform
    intrinsics_assumed: bool = False
    session_id: Name = ""


class Posture(Message):
    """One agent's posture, egocentric (x left, y up, z forward); a joint that the source lacks is null.

    `joints_m` are the measured joints in metres, `joints` the same posture with standard bone lengths: a joint is null
    there where one on its way from the torso is. `upright` is `joints` again, relative to the torso, with y up along
    gravity, z horizontal, and the actor's heading smoothed over a second.
    `motion` is the mean displacement (m) of each part of `skeletons.PARTS` since the last valid frame, of joints
    relative to the torso and low-passed; 0 for a part of which no joint is known.
    `depth_std_m` is the agent's, `up_in_camera` the camera's of the skeleton.
    `agents` names every agent of the captured frame, `previous_ns` is the stamp of the captured frame before it
    (its postures may be on other agents' keys), `missed` counts the frames lost just before this one.
    """

    SCHEMA = "actum.posture"
    agent: AgentId
    joints_m: Joints | None
    joints: Joints | None
    upright: Joints | None = None
    ego_from_camera: Transform | None
    motion: Annotated[list[FiniteFloat], Field(min_length=5, max_length=5)] | None
    frame: Name = "egocentric"
    depth_std_m: Deviation | None = None
    up_in_camera: Direction | None = None
    agents: Annotated[list[AgentId], Field(max_length=MOST_AGENTS)] = Field([])
    previous_ns: Stamp | None = None
    missed: Seq = 0
    session_id: Name = ""


class TrackedObject(Model):
    """One object's pose in the skeleton's camera frame; `seen` is false while it is only remembered.

    `velocity_mps` is null where it is not known. Of an object that is not seen, `followed` tells that what covers it is
    followed in the image instead, `predicted` that it has been carried on with its velocity; if neither, it is listed
    where it was expected last.
    """

    id: Annotated[int, Field(ge=0, lt=2**31)]
    name: Name
    position_m: FinitePoint
    quaternion_xyzw: Quaternion
    confidence: FiniteFloat
    seen: bool
    velocity_mps: FinitePoint | None = None
    predicted: bool = False
    followed: bool = False


class Objects(Message):
    """All objects of one image."""

    SCHEMA = "actum.objects"
    objects: Annotated[list[TrackedObject], Field(max_length=MOST_OBJECTS)]
    session_id: Name = ""
