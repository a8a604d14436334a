"""What services tell of themselves, and the simulated scene of what it did."""

from typing import Annotated, Literal

from pydantic import Field

from actum.messages.base import FinitePoint, Hand, Message, SegmentId


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
    """What a service is: answered on its queryable."""

    SCHEMA = "actum.info"
    service: str
    instance: str
    version: str
    schemas: list[str]
    joint_names: list[str]
    model: str | None = None
    calibration: str | None = None


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
