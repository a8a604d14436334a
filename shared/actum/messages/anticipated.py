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

MOST_INTENDED = 2 * MOST_OBJECTS
"""Most contacts in one message: one of each hand with each object."""


class Intended(Model):
    """A contact of one hand with one object that may be about to happen."""

    action: Name | None
    """The likeliest ongoing action that people do to objects; null where none is known."""
    object_id: int
    """The object's number."""
    object_name: Name
    """What the object is called."""
    hand: Hand
    """The hand that is on its way."""
    probability: FiniteFloat
    """The probability that this hand touches this object within the next 1.5 s and does the action to it, 0 to 1."""
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
    intended: Annotated[list[Intended], Field(max_length=MOST_INTENDED)]
    """The possible contacts, the likeliest first. The probabilities sum to 1 at most; the rest is the probability that
    none of these contacts happens. Empty once, when the reach is over; nothing follows until the next reach."""
    completeness: FiniteFloat | None = None
    """How much of the ongoing action has been done, 0 to 1; null where no action is known to go on."""
    segment_id: SegmentId | None = None
    """The name of the ongoing segment, marked or found; null where there is none."""
    session_id: Name = ""
    """The run of the source, as the posture's."""
