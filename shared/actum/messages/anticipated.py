"""The messages about what is about to happen: which object a hand will touch, and how a posture goes on."""

from typing import Annotated

from pydantic import Field, FiniteFloat

from actum.messages.base import (
    MOST_OBJECTS,
    AgentId,
    Deviation,
    FinitePoint,
    Hand,
    Joints,
    Message,
    Model,
    Name,
    SegmentId,
)

MOST_HORIZONS = 8
"""Most postures in one continuation: a classifier puts three."""


class Intended(Model):
    """A contact with one object that may be about to happen."""

    object_id: int
    """The object's number."""
    object_name: Name
    """What the object is called."""
    hand: Hand
    """The hand that is on its way to the object; if both are, the likelier one."""
    probability: FiniteFloat
    """The probability that the person touches this object next, within 1.5 s, 0 to 1."""
    soon_probability: FiniteFloat
    """The probability that the person touches this object within 1.5 s, next or after another one, 0 to 1. It is
    greater than `probability` while the hands reach for different objects: only one can be next, both are touched."""
    action: Name | None = None
    """The likeliest ongoing action if the person touches this object; null if none is known, or if the action is marked
    for the other hand."""
    action_probability: FiniteFloat | None = None
    """The probability that the person touches this object next and does `action` to it: `probability` times that of
    `action` for this object, which follows from the action's confidence and from what each action was done to before;
    null if `action` is null."""
    contact_s: FiniteFloat
    """The expected time from `stamp_ns` to the contact (s)."""
    contact_std_s: Deviation
    """The standard deviation of `contact_s` (s)."""
    place_m: FinitePoint
    """Where the hand will be at the contact (m), in the camera frame of the skeletons."""


class Intent(Message):
    """What a person is about to touch, before it happens: one for each posture while a reach may be under way."""

    SCHEMA = "actum.intent"
    agent: AgentId
    """The number of the person who is about to touch something."""
    intended: Annotated[list[Intended], Field(max_length=MOST_OBJECTS)]
    """The possible contacts, the likeliest first. Their `probability` sums to 1 at most; the rest is the probability
    that none of these contacts happens. When the reach is over, one message has an empty list, and none follows until
    the next reach."""
    completeness: FiniteFloat | None = None
    """The fraction of the ongoing action that has been done, 0 to 1; null if no ongoing action is known."""
    segment_id: SegmentId | None = None
    """The name of the ongoing segment, marked or found; null if there is none."""
    session_id: Name = ""
    """The run of the source, as in the posture."""


class PostureAhead(Model):
    """A posture that a person is expected to have."""

    ahead_s: FiniteFloat
    """How long after `stamp_ns` (s)."""
    joints_m: Joints
    """The fifteen joints in the order of `info.joint_names` (m), in the camera frame of the skeletons; null if the
    posture lacks one. The bones are about as long as the person's; the torso stays where it is at `stamp_ns`."""


class Continuation(Message):
    """How a person's posture goes on: one for each posture of a person who moves or has moved in the last half second.

    Put only while somebody listens, and only by a classifier whose model was trained with `--continue`.
    """

    SCHEMA = "actum.continuation"
    agent: AgentId
    """The number of the person whose posture it is."""
    ahead: Annotated[list[PostureAhead], Field(max_length=MOST_HORIZONS)]
    """The expected postures, the soonest first: after 0.25, 0.5 and 1 s. Each is the mean of what may follow, so that
    far movements look smaller than they will be."""
    session_id: Name = ""
    """The run of the source, as in the posture."""
