"""What is recognised of a segment: its marks, its action, its event."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import AgentId, Count, FinitePoint, Hand, Message, Model, Name, Reason, SegmentId, Stamp


class Tensor(Model):
    """A dense array: `dtype` in NumPy's notation with byte order, C order."""

    dtype: str
    shape: list[int]
    data: bytes


class Segment(Message):
    """A start or end mark; anyone may put one with just `kind` and `segment_id`."""

    SCHEMA = "actum.segment"
    stamp_ns: Stamp | None = None  # type: ignore[assignment]
    kind: Literal["start", "end"]
    segment_id: SegmentId
    agent: Annotated[int, Field(ge=1, lt=2**31)] | None = None
    hand: Hand | None = None
    label: Name | None = None


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
    missing_joints: list[Name] = Field([])
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
    missing_joints: list[Name] = Field([])
    candidates: list[ActedObject] = Field([])
    pointing: Pointing | None = None
    outcome: Name | None = None
    agrees: bool | None = None
    why: Reason | None = None
