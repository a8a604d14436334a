"""Messages about what is recognised in a segment: the action, what was held back, the event."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import (
    MOST_ACTIONS,
    AgentId,
    Count,
    FinitePoint,
    Hand,
    Message,
    Model,
    Name,
    Quaternion,
    Reason,
    SegmentId,
    Stamp,
)

Activations = Annotated[dict[str, FiniteFloat], Field(max_length=MOST_ACTIONS)]


class Tensor(Model):
    """A dense array."""

    dtype: Name
    """The kind of number in NumPy's notation with byte order, such as `<f4`."""
    shape: list[int]
    """The lengths of the axes."""
    data: bytes
    """The numbers, last axis fastest (C order)."""


class Action(Message):
    """What the classifier sees: partial per frame while an action goes on, marked or not; `final` once it has ended."""

    SCHEMA = "actum.action"
    agent: AgentId
    """Who acts; 0 where nobody is sure who it is."""
    segment_id: SegmentId
    """The segment's name, as it was marked; of what goes on that nobody marked, the name that it will get."""
    start_ns: Stamp
    """The stamp of the segment's start (ns)."""
    end_ns: Stamp | None
    """The stamp of its end (ns); null while it is open."""
    final: bool
    """Whether the segment has ended, so that this is its only answer; partial ones come per frame before."""
    action: Name | None
    """The likeliest action; null where there is none."""
    confidence: FiniteFloat
    """The probability that `action` is right, calibrated on people held out, 0 to 1."""
    activations: Activations
    """The activity of each trained action's neuron, by the action's name; empty in partial ones that nobody marked."""
    part: Name | None
    """The body part that moved most: right_arm, left_arm, right_leg, left_leg or body; null where none is known."""
    frames: Count
    """How many valid postures it rests on."""
    missed: Count
    """How many frames of the segment were lost on the way."""
    hand: Hand | None = None
    """The hand that was marked; null where none was."""
    unknown: bool = False
    """Whether it may be none of the trained actions: it is less like its action than most true instances are."""
    familiarity: FiniteFloat | None = None
    """Probability that the segment is a true instance of `action`, not another movement; null in partial actions and
    where the model cannot tell."""
    missing_joints: list[Name] = Field([])
    """The names of the joints that some frame lacked for longer than 0.3 s."""
    completeness: FiniteFloat | None = None
    """How much of the action has been done, 0 to 1; null in final ones and where the model cannot tell."""
    maps: dict[str, Tensor] | None = None
    """The mean activity of each map over the segment, rows by columns, by the map's name; null unless asked for."""
    trace: Tensor | None = None
    """The way over the first map, a row and a column per step; null unless asked for."""
    session_id: Name = ""
    """The run of the source, as the posture's; empty where no posture had come."""


WhyHeldBack = Literal["unknown", "disabled", "pause", "cooldown", "unanswerable"]
"""Why a segment that was found is not published; `status` counts by these words."""


class HeldBack(Message):
    """A segment that the classifier found but did not publish as an action, and the reason."""

    SCHEMA = "actum.held_back"
    agent: AgentId
    """Who acts."""
    start_ns: Stamp
    """The stamp of its start (ns)."""
    end_ns: Stamp
    """The stamp of its end (ns)."""
    action: Name
    """The action that it is most like."""
    confidence: FiniteFloat
    """The probability that `action` is right if it is one of the trained actions, 0 to 1."""
    familiarity: FiniteFloat | None
    """Probability that the segment is a true instance of `action`, not another movement; null where the model cannot
    tell."""
    why: WhyHeldBack
    """Why it is not published: it is not enough like `action` (unknown); the settings disable the action (disabled);
    it follows another action too soon (pause), or one of the same name (cooldown), for the settings; or it has too few
    usable frames (unanswerable)."""
    sentence: str
    """The reason in one line, for people."""
    session_id: Name = ""
    """The run of the source, as the action's."""


class ObjectPose(Model):
    """Where an object is at the end of an action, in one frame."""

    frame: Name
    """The frame: `camera`, that of the skeletons, or the fixed frame's name, as `action_fusion` was told."""
    position_m: FinitePoint
    """Where its middle is (m)."""
    quaternion_xyzw: Quaternion | None
    """The rotation from its own axes to the frame's, as a unit quaternion; null where a hand has moved it since it was
    seen last, so that only its place is known."""


class ActedObject(Model):
    """The object an action is applied to, and how close the hand came to it."""

    id: int
    """The object's number."""
    name: Name
    """What it is called."""
    distance_m: FiniteFloat
    """The smallest distance from the hand's joint to it during the segment (m)."""
    carried: bool = False
    """How its motion is known: true where, for a while, a hand covered it and its place was taken from that hand.
    A thing that is seen all the way is false here though it was lifted: see `taken_along`."""
    taken_along: bool = False
    """Whether the hand that acted moved it during the segment, it going as the hand went: lifted, put, pushed …, seen
    or covered."""
    in_hand_at_end: bool = False
    """Whether, as the segment ends, it is still in the hand that had it: where it was in it, within a decimetre. That
    the fingers are closed is not seen, so that a hand that rests on what it has put down counts too."""
    last_seen_ns: Stamp | None = None
    """When it was seen last, up to the segment's end (ns); null where it was not."""
    pose: ObjectPose | None = None
    """Where it is at the segment's end, in the camera frame of the skeletons: where it was seen last, or where the hand
    that has covered it since has it or has left it; null where the sender does not tell. An object that came back is at
    its first place again, though `motion` is measured at the turn."""
    fixed_pose: ObjectPose | None = None
    """The same in the fixed frame that `action_fusion` was told of; null where it was told of none."""


class HeldObject(Model):
    """The object in the hand: what is acted on itself, or the tool that is applied to it."""

    id: int
    """The object's number."""
    name: Name
    """What it is called."""


class Pointing(Model):
    """How well the arm points at the object."""

    angle_deg: FiniteFloat
    """How far off the line of the arm the object is (degrees)."""
    margin_deg: FiniteFloat | None
    """How much further off the next object is (degrees); null where there is no other."""


class Motion(Model):
    """How the object moved in the segment, in the level frame of its first posture: right, up, forward."""

    displacement_m: FinitePoint
    """From its place at the segment's start to that at its end or, where it came back, at `turn_ns` (m): right, up,
    forward of the person."""
    direction: Name | None = None
    """The word for the axis on which it moved most: right, left, up, down, away, towards, or sideways where the
    person's forward is not known; null where it did not move."""
    turn_ns: Stamp | None = None
    """When the object was furthest from its place at the segment's start, if it came back from there in the segment,
    as a cup that is lifted and set down again (ns); null where it did not come back."""


class Event(Message):
    """The product: what was done, to which object, and what became of it."""

    SCHEMA = "actum.event"
    agent: AgentId
    """Who acted; 0 where nobody is sure who it is."""
    segment_id: SegmentId
    """The segment's name, as it was marked."""
    start_ns: Stamp
    """The stamp of the segment's start (ns)."""
    end_ns: Stamp
    """The stamp of its end (ns)."""
    action: Name | None
    """What was done; null where it was not recognised."""
    confidence: FiniteFloat
    """The probability that `action` is right, 0 to 1."""
    activations: Activations
    """The activity of each trained action's neuron, by the action's name."""
    object: ActedObject | None
    """What it was done to; null where it was nothing, see `why`."""
    held: HeldObject | None
    """What was in the hand: the object itself or a tool; null where nothing was."""
    hand: Hand | None
    """Which hand acted; null where it is not known."""
    objects_present: list[int]
    """The numbers of the objects seen during the segment."""
    distances_m: dict[str, FiniteFloat]
    """The smallest distance (m) of a hand that may have acted to each object, by its number."""
    motion: Motion | None
    """How the object moved; null where there is none."""
    result: str | None
    """The motion in words, such as `0.18 m up` or `unmoved`; null where there is no object."""
    sentence: str
    """All of it in one line, for people."""
    frames: Count
    """How many valid postures the action rests on."""
    missed: Annotated[int, Field(ge=0, lt=2**63)]
    """How many frames were lost on the way, to the classifier and to the fusion."""
    unknown: bool = False
    """Whether it may be none of the trained actions."""
    missing_joints: list[Name] = Field([])
    """The names of the joints that some frame lacked for longer than 0.3 s."""
    candidates: list[ActedObject] = Field([])
    """Two or more objects that are as likely, the likeliest first; empty where one is."""
    pointing: Pointing | None = None
    """How well the arm points at the object; null where nothing is pointed at."""
    outcome: Name | None = None
    """What became of the object by `motion`: lifted, put down, pushed, pulled, moved or unmoved; null where there is
    none."""
    agrees: bool | None = None
    """Whether `outcome` is what the action is to do; null where it is not to do something of the kind, or where what
    was to be pushed or pulled went sideways."""
    why: Reason | None = None
    """Why there is no object, and which ones another moved; null where there is one."""
    session_id: Name = ""
    """The run of the source, as the action's."""
