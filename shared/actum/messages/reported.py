"""Messages in which services describe themselves, and the simulated scene's ground truth."""

from typing import Annotated, Literal

from pydantic import Field

from actum.messages.base import FinitePoint, Hand, Message, Model, Name, SegmentId


class HopTime(Model):
    """How long after its cause a message is received, over the last minute, by the clock of the receiving service."""

    cause: str
    """The earlier message, such as `skeleton` or `end mark`."""
    effect: str
    """The later message, such as `posture` or `event`."""
    count: int
    """Pairs in the last minute."""
    p50_ms: float
    """Median time (ms), right to 2.5 %."""
    p99_ms: float
    """Time (ms) that 99 of 100 pairs do not exceed, right to 2.5 %; with fewer than a hundred pairs the longest."""


class Status(Message):
    """A service's health, once a second."""

    SCHEMA = "actum.status"
    service: str
    """The service's name."""
    instance: str
    """This process among others of the service."""
    uptime_s: float
    """Seconds since it started."""
    rates: dict[str, float]
    """Messages handled a second (Hz) since the last status, by key."""
    handled: dict[str, int]
    """Messages handled since the start, by key."""
    drops: dict[str, int]
    """Messages lost on the way since the start, told by gaps in `seq`, by key."""
    rejects: dict[str, int]
    """Messages and segments that could not be used since the start, by kind of problem."""
    last_error: str | None
    """The latest problem in words; null where there was none."""
    latency_ms: dict[str, float]
    """Milliseconds from a message's arrival to the last put of its answer, over the recent past: `p50` and `p99`."""
    state: str
    """What the service is doing, in words, such as `running`."""
    counts: dict[str, int] = Field({})
    """What else happened since the start and is no fault, by kind: the classifier counts here the actions that it
    found without marks, and what became of them."""
    hops: list[HopTime] = Field([])
    """Where the time goes between messages, as the page's service receives them; empty for other services."""


class Info(Message):
    """What a service is: answered on its queryable."""

    SCHEMA = "actum.info"
    service: str
    """The service's name."""
    instance: str
    """This process among others of the service."""
    version: str
    """The version of actum it runs."""
    schemas: list[str]
    """The schemas it speaks, such as `actum.event/1`."""
    joint_names: list[str]
    """The names of the fifteen joints, in the order of every list of joints."""
    model: str | None = None
    """Which model the classifier has loaded; null where there is none."""
    calibration: str | None = None
    """Which calibration the images carry; null where there is none."""
    host: str | None = None
    """The machine it runs on."""
    source: str | None = None
    """What a gateway reads: a simulated scene, a file, a camera; null for other services."""
    rate_hz: float | None = None
    """How many frames a second a gateway's source is set to give (Hz); null where it does not say."""
    page: str | None = None
    """The address of the page that it serves to browsers; null for other services."""
    commands: list[str] = Field([])
    """The names of the commands that it can be asked for, such as `parameters`."""


class Truth(Message):
    """What the simulated scene really did: put at the start and at the end of each action."""

    SCHEMA = "actum.truth"
    kind: Literal["start", "end"]
    """Whether it stands in the action's first or its last frame."""
    segment_id: SegmentId
    """The segment's name."""
    agent: Annotated[int, Field(ge=1, lt=2**31)]
    """Who acts."""
    hand: Hand
    """The hand that acts."""
    action: Name
    """What is really done."""
    object_id: int
    """The number of the object it is done to; -1 for a pantomime."""
    object_name: Name
    """Its name; empty for a pantomime."""
    displacement_m: FinitePoint | None
    """How far the object moved, camera frame (m), at the end; null at the start and for a pantomime."""
