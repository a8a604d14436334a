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
    """The number of the person who acts; 0 if unidentified."""
    segment_id: SegmentId
    """The segment's name, as in its marks; for an ongoing action without marks, the name that its segment will get."""
    start_ns: Stamp
    """The stamp of the segment's start (ns)."""
    end_ns: Stamp | None
    """The stamp of the segment's end (ns); null while the segment is open."""
    final: bool
    """Whether the segment has ended. A segment has one final message; partial messages come before, one per frame."""
    action: Name | None
    """The likeliest action; null if there is none."""
    confidence: FiniteFloat
    """The probability that `action` is right if it is one of the trained actions, calibrated on people left out of the
    training, 0 to 1."""
    activations: Activations
    """The activity of each trained action's neuron, by the action's name; empty in partial messages without marks."""
    part: Name | None
    """The body part that moved most: right_arm, left_arm, right_leg, left_leg or body; null if unknown."""
    frames: Count
    """Number of valid postures that the answer is based on."""
    missed: Count
    """Number of frames of the segment that were lost."""
    hand: Hand | None = None
    """The hand that the mark names; null if it names none."""
    unknown: bool = False
    """Whether the segment may be none of the trained actions: it is less like `action` than most true instances are."""
    familiarity: FiniteFloat | None = None
    """Probability that the segment is a true instance of `action`, not another movement; null in partial messages, if
    the person was seen only during the segment's beginning, and if the model cannot compute it."""
    missing_joints: list[Name] = Field([])
    """The names of the joints that were missing in some frame for longer than 0.3 s."""
    completeness: FiniteFloat | None = None
    """The fraction of the action that has been done, 0 to 1; null in final messages, and if the model cannot compute
    it."""
    maps: dict[str, Tensor] | None = None
    """The mean activity of each map over the segment, rows by columns, by the map's name; null without
    `--publish-maps`."""
    trace: Tensor | None = None
    """The path over the first map, a row and a column per step; null without `--publish-maps`."""
    session_id: Name = ""
    """The run of the source, as in the posture; empty if no posture had arrived."""


WhyHeldBack = Literal["unknown", "disabled", "pause", "cooldown", "unanswerable"]
"""Why a segment that was found is not published; `status` counts by these words."""


class HeldBack(Message):
    """A segment that the classifier found but did not publish as an action, and the reason."""

    SCHEMA = "actum.held_back"
    agent: AgentId
    """The number of the person who acts."""
    start_ns: Stamp
    """The stamp of the segment's start (ns)."""
    end_ns: Stamp
    """The stamp of the segment's end (ns)."""
    action: Name
    """The action that the segment is most like."""
    confidence: FiniteFloat
    """The probability that `action` is right if it is one of the trained actions, 0 to 1."""
    familiarity: FiniteFloat | None
    """Probability that the segment is a true instance of `action`, not another movement; null if the model cannot
    compute it."""
    why: WhyHeldBack
    """Why the segment is not published: it is not enough like `action` (unknown); the settings disable `action`
    (disabled); by the settings, it follows too soon after another action (pause) or after the same action (cooldown);
    or it has too few usable frames (unanswerable)."""
    sentence: str
    """The reason in one line, for people."""
    session_id: Name = ""
    """The run of the source, as in the action."""


class ObjectPose(Model):
    """Where an object is at the end of an action, in one frame."""

    frame: Name
    """The name of the frame: `camera` for the camera frame of the skeletons, otherwise the name set by
    `ACTUM_WORLD_FRAME`."""
    position_m: FinitePoint
    """The position of the object's centre (m)."""
    quaternion_xyzw: Quaternion | None
    """The rotation from the object's own axes to those of the frame, as a unit quaternion; null if a hand has moved the
    object since it was last seen, so that only its position is known."""


class ActedObject(Model):
    """The object an action is applied to, and how close the hand came to it."""

    id: int
    """The object's number."""
    name: Name
    """The object's name."""
    distance_m: FiniteFloat
    """The smallest distance between the hand's joint and the object during the segment (m)."""
    carried: bool = False
    """Whether, for a while during the segment, a hand covered the object and the object's place was taken from that
    hand. False for an object that was always visible, even if it was lifted: see `taken_along`."""
    taken_along: bool = False
    """Whether the hand that acted moved the object during the segment, so that both moved together: lifted, put, pushed
    …, visible or covered."""
    in_hand_at_end: bool = False
    """Whether, at the segment's end, the object is still at its place in the hand that had it, within a decimetre.
    Fingers are not seen, so a hand that rests on an object that it has put down counts too."""
    last_seen_ns: Stamp | None = None
    """When the object was last seen, up to the segment's end (ns); null if it was not seen."""
    pose: ObjectPose | None = None
    """The object's pose at the segment's end, in the camera frame of the skeletons: where it was last seen, or where
    the hand that has covered it since then has it or has left it; null if the sender does not report it. If the object
    came back, the pose is at its first place, although `motion` is measured at the turn."""
    fixed_pose: ObjectPose | None = None
    """The same pose in the fixed frame that `ACTUM_WORLD_FROM_CAMERA` defines; null if that is not set."""


class HeldObject(Model):
    """The object in the hand: what is acted on itself, or the tool that is applied to it."""

    id: int
    """The object's number."""
    name: Name
    """The object's name."""


class Pointing(Model):
    """How well the arm points at the object."""

    angle_deg: FiniteFloat
    """The angle between the line of pointing and the object (degrees)."""
    margin_deg: FiniteFloat | None
    """How much larger the angle of the next object is (degrees); null if there is no other object."""


class Motion(Model):
    """How the object moved in the segment, in the level frame of its first posture: right, up, forward."""

    displacement_m: FinitePoint
    """From the object's place at the segment's start to its place at the end or, if it came back, at `turn_ns` (m):
    right, up, forward of the person."""
    direction: Name | None = None
    """The direction in which the object moved most: right, left, up, down, away, towards, or sideways if the person's
    forward direction is unknown; null if the object did not move."""
    turn_ns: Stamp | None = None
    """When the object was furthest from its place at the segment's start (ns), if it came back during the segment, like
    a cup that is lifted and set down again; null if it did not come back."""


class Event(Message):
    """The product: what was done, to which object, and what became of it."""

    SCHEMA = "actum.event"
    agent: AgentId
    """The number of the person who acted; 0 if unidentified."""
    segment_id: SegmentId
    """The segment's name, as in its marks."""
    start_ns: Stamp
    """The stamp of the segment's start (ns)."""
    end_ns: Stamp
    """The stamp of its end (ns)."""
    action: Name | None
    """The action that was done; null if none was recognised."""
    confidence: FiniteFloat
    """The probability that `action` is right if it is one of the trained actions, 0 to 1."""
    activations: Activations
    """The activity of each trained action's neuron, by the action's name."""
    object: ActedObject | None
    """The object that the action was done to; null if there was none, for the reason in `why`."""
    held: HeldObject | None
    """The object in the hand: `object` itself or a tool; null if the hand held nothing."""
    hand: Hand | None
    """The hand that acted; null if unknown."""
    objects_present: list[int]
    """The numbers of the objects seen during the segment, or up to 0.9 s before it."""
    distances_m: dict[str, FiniteFloat]
    """The smallest distance (m) between each object, by its number, and a hand that may have acted."""
    motion: Motion | None
    """How the object moved; null if there is no object or its motion is unknown."""
    result: str | None
    """The motion in words, such as `0.18 m up` or `unmoved`; null if `motion` is null."""
    sentence: str
    """The whole event in one line, for people."""
    frames: Count
    """Number of valid postures that the action is based on."""
    missed: Annotated[int, Field(ge=0, lt=2**63)]
    """Number of frames that were lost on the way to the classifier and to the fusion."""
    unknown: bool = False
    """Whether the segment may be none of the trained actions."""
    familiarity: FiniteFloat | None = None
    """Probability that the segment is a true instance of `action`, as in the action's message."""
    missing_joints: list[Name] = Field([])
    """The names of the joints that were missing in some frame for longer than 0.3 s."""
    candidates: list[ActedObject] = Field([])
    """Two or more objects that are about equally likely, the likeliest first; empty if one is clearly likeliest."""
    pointing: Pointing | None = None
    """How well the arm points at the object; null if nothing is pointed at."""
    outcome: Name | None = None
    """What happened to the object, from `motion`: lifted, put down, pushed, pulled, moved or unmoved; null if `motion`
    is null."""
    agrees: bool | None = None
    """Whether `outcome` is the one expected of the action; null if the action has no expected outcome, or if an object
    to be pushed or pulled moved sideways."""
    why: Reason | None = None
    """Why there is no object, and which objects another person moved; null if there is an object."""
    session_id: Name = ""
    """The run of the source, as in the action."""
