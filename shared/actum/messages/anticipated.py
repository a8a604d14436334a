"""The message about what is about to happen: which object a hand is on its way to, before the hand arrives."""

from typing import Annotated

from pydantic import Field, FiniteFloat

from actum.messages.base import (
    MOST_OBJECTS,
    AgentId,
    Deviation,
    FinitePoint,
    Hand,
    Message,
    Model,
    Name,
    SegmentId,
)


class Intended(Model):
    """A contact with one object that may be about to happen."""

    object_id: int
    """The object's number."""
    object_name: Name
    """What the object is called."""
    hand: Hand
    """The hand that is on its way; of both hands the likelier one."""
    probability: FiniteFloat
    """The probability that this object is what the person touches next, within 1.5 s, 0 to 1."""
    soon_probability: FiniteFloat
    """The probability that this object is touched within 1.5 s, next or after another one, 0 to 1. It is greater than
    `probability` while both hands are on their way to different objects: either object may be next, and both will be
    touched."""
    action: Name | None = None
    """The likeliest ongoing action; null where none is known, or where it is marked as one of the other hand."""
    action_probability: FiniteFloat | None = None
    """The probability that the person touches this object next and does `action` to it: `probability` times the
    action's confidence; null where `action` is."""
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
    """Who is about to touch something."""
    intended: Annotated[list[Intended], Field(max_length=MOST_OBJECTS)]
    """The possible contacts, the likeliest first. Their `probability` sums to 1 at most; the rest is the probability
    that none of them happens. Empty once, when the reach is over; nothing follows until the next reach."""
    completeness: FiniteFloat | None = None
    """How much of the ongoing action has been done, 0 to 1; null where no action is known to go on."""
    segment_id: SegmentId | None = None
    """The name of the ongoing segment, marked or found; null where there is none."""
    session_id: Name = ""
    """The run of the source, as the posture's."""
