"""Every message that crosses a Zenoh key, as frozen models; the JSON Schemas are generated from here.

Units are SI and named in the field where not obvious. Positions are in the sensor's camera frame (metres,
x right, y down, z forward) unless the field says otherwise. Transforms are 4x4, row-major, 16 numbers.
"""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat

Stamp = Annotated[int, Field(ge=0, lt=2**62)]
Seq = Annotated[int, Field(ge=0, lt=2**40)]
Count = Annotated[int, Field(ge=0, lt=2**62)]
AgentId = Annotated[int, Field(ge=0, lt=2**31)]
Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Joint = Point | None
Joints = Annotated[list[Joint], Field(min_length=15, max_length=15)]
FinitePoint = Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[FiniteFloat], Field(min_length=4, max_length=4)]
Transform = Annotated[list[FiniteFloat], Field(min_length=16, max_length=16)]
Intrinsics = Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
SegmentId = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, Field(max_length=200)]
Reason = Annotated[str, Field(max_length=1000)]
Deviation = Annotated[FiniteFloat, Field(ge=0)]
Hand = Literal["left", "right"]

MANUAL, SIMULATOR, REPLAY = "manual", "simulator", "replay"
"""Who puts marks: a person, the simulated scene, a recording that is played."""

MOST_AGENTS = 64
MOST_OBJECTS = 1024
_SHORTEST = 1e-3


def _nonzero(direction: list[float]) -> list[float]:
    if not _SHORTEST < math.hypot(*direction) < 1 / _SHORTEST:
        raise ValueError(f"{direction} has no direction: [0, -1, 0] is up for a level camera")
    return direction


Direction = Annotated[FinitePoint, AfterValidator(_nonzero)]


class Message(BaseModel):
    """What every message carries: capture time on the sensor's clock, number per key, viewpoint, validity.

    `seq` is filled in by the runtime where a node leaves it out.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True, ser_json_inf_nan="constants")
    SCHEMA: ClassVar[str]
    VERSION: ClassVar[int] = 1

    stamp_ns: Stamp
    seq: Seq | None = None
    sensor: str
    valid: bool = True
    reason: Reason | None = None


class Model(BaseModel):
    """A part of a message."""

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)


class Tensor(Model):
    """A dense array: `dtype` in NumPy's notation with byte order, C order."""

    dtype: str
    shape: list[int]
    data: bytes


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
    agents: Annotated[list[AgentId], Field(max_length=MOST_AGENTS)] = []
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


class Segment(Message):
    """A start or end mark; anyone may put one with just `kind` and `segment_id`.

    `origin` tells who put it: `manual` for a person at a switch, `simulator` for the simulated scene, `replay` for a
    recording that is played. A mark without it is the user's, by a program of theirs.
    """

    SCHEMA = "actum.segment"
    stamp_ns: Stamp | None = None  # type: ignore[assignment]
    kind: Literal["start", "end"]
    segment_id: SegmentId
    agent: Annotated[int, Field(ge=1, lt=2**31)] | None = None
    hand: Hand | None = None
    label: Name | None = None
    origin: Name | None = None


class Action(Message):
    """What the classifier sees in a segment: partial per frame while it is open, `final` once at its end.

    `confidence` is the probability that the action is right, `unknown` tells that it may be none of those trained
    (`familiarity`, of the model's own scale, is too low), `missing_joints` which joints some frame lacked.
    """

    SCHEMA = "actum.action"
    agent: AgentId
    segment_id: SegmentId
    start_ns: Stamp
    end_ns: Stamp | None
    final: bool
    action: Name | None
    confidence: FiniteFloat
    activations: dict[str, FiniteFloat]
    part: Name | None
    frames: Count
    missed: Count
    hand: Hand | None = None
    unknown: bool = False
    familiarity: FiniteFloat | None = None
    missing_joints: list[Name] = []
    maps: dict[str, Tensor] | None = None
    trace: Tensor | None = None


class ActedObject(Model):
    """The object an action is applied to, and how close the hand came to it.

    It is `carried` where a hand covered it for a while and its track there is the hand's.
    """

    id: int
    name: str
    distance_m: FiniteFloat
    carried: bool = False


class HeldObject(Model):
    """The object in the hand: what is acted on itself, or the tool that is applied to it."""

    id: int
    name: str


class Pointing(Model):
    """How far off the arm's line the object is, and how much further the runner-up; null where there is no other."""

    angle_deg: FiniteFloat
    margin_deg: FiniteFloat | None


class Motion(Model):
    """How the object moved over the segment, in the level frame of its first posture: right, up, forward.

    `direction` is the word for the axis on which it moved most, null where it did not move.
    """

    displacement_m: FinitePoint
    direction: Name | None = None


class Event(Message):
    """The product: what was done, to which object, and what became of it.

    `candidates` are two or more objects that are as likely, the likeliest first; empty where one is. `why` tells why
    there is no object. `outcome` is lifted, put down, pushed, pulled, moved or unmoved, and `agrees` whether that is
    what the action is to do; null where the action is not one that is to do something of the kind, or where what was to
    be pushed or pulled went sideways.
    """

    SCHEMA = "actum.event"
    agent: AgentId
    segment_id: SegmentId
    start_ns: Stamp
    end_ns: Stamp
    action: str | None
    confidence: FiniteFloat
    activations: dict[str, FiniteFloat]
    object: ActedObject | None
    held: HeldObject | None
    hand: Hand | None
    objects_present: list[int]
    distances_m: dict[str, FiniteFloat]
    motion: Motion | None
    result: str | None
    sentence: str
    frames: Count
    missed: Annotated[int, Field(ge=0, lt=2**63)]
    unknown: bool = False
    missing_joints: list[Name] = []
    candidates: list[ActedObject] = []
    pointing: Pointing | None = None
    outcome: Name | None = None
    agrees: bool | None = None
    why: Reason | None = None


class Status(Message):
    """A service's health, once a second: rates in Hz per key, counts since start, latency of handling."""

    SCHEMA = "actum.status"
    service: str
    instance: str
    uptime_s: float
    rates: dict[str, float]
    handled: dict[str, int]
    drops: dict[str, int]
    rejects: dict[str, int]
    last_error: str | None
    latency_ms: dict[str, float]
    state: str


class Info(Message):
    """What a service is: answered on its queryable.

    `host` is the machine it runs on. `source` tells what a gateway reads: a simulated scene, a file, a camera.
    """

    SCHEMA = "actum.info"
    service: str
    instance: str
    version: str
    schemas: list[str]
    joint_names: list[str]
    model: str | None = None
    calibration: str | None = None
    host: str | None = None
    source: str | None = None


class Truth(Message):
    """What the simulated scene really did: put at the start and at the end of each action."""

    SCHEMA = "actum.truth"
    kind: Literal["start", "end"]
    segment_id: SegmentId
    agent: Annotated[int, Field(ge=1, lt=2**31)]
    hand: Hand
    action: str
    object_id: int
    object_name: str
    displacement_m: FinitePoint | None


MESSAGES: tuple[type[Message], ...] = (
    Skeleton,
    Image,
    Posture,
    Objects,
    Segment,
    Action,
    Event,
    Status,
    Info,
    Truth,
)
