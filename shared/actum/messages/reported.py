"""Messages in which services describe themselves, and the simulated scene's ground truth."""

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from actum.messages.base import FinitePoint, Hand, Message, Model, Name, SegmentId


class HopTime(Model):
    """How long after its cause a message is received, over the last minute, by the clock of the receiving service."""

    cause: str
    """The earlier message, such as `skeleton` or `end mark`."""
    effect: str
    """The later message, such as `posture` or `event`."""
    count: int
    """Pairs in the last minute."""
    p50_ms: FiniteFloat
    """Median time (ms), right to 2.5 %."""
    p99_ms: FiniteFloat
    """Time (ms) that 99 of 100 pairs do not exceed, right to 2.5 %; with fewer than a hundred pairs the longest."""


class Status(Message):
    """A service's health, once a second."""

    SCHEMA = "actum.status"
    service: str
    """The service's name."""
    instance: str
    """The name of this process of the service."""
    uptime_s: float
    """Seconds since the process started."""
    rates: dict[str, float]
    """Messages handled per second (Hz) since the last status, by key."""
    handled: dict[str, int]
    """Messages handled since the start, by key."""
    drops: dict[str, int]
    """Messages lost on the way since the start, found by gaps in `seq`, by key."""
    rejects: dict[str, int]
    """Messages and segments that could not be used since the start, by kind of problem."""
    last_error: str | None
    """The latest problem in words; null if there was none."""
    latency_ms: dict[str, float]
    """Milliseconds from the arrival of a message until the last of its answers is published, recently: `p50` and
    `p99`."""
    state: str
    """What the service is doing, in words, such as `running`."""
    counts: dict[str, int] = Field({})
    """What else happened since the start and is no fault, by kind, such as how many segments the classifier found
    without marks, and how many of these it dropped and why."""
    hops: list[HopTime] = Field([])
    """Where the time goes between messages, as the page's service receives them; empty for other services."""


class Info(Message):
    """What a service is: answered on its queryable."""

    SCHEMA = "actum.info"
    service: str
    """The service's name."""
    instance: str
    """The name of this process of the service."""
    version: str
    """The version of actum that the service runs."""
    schemas: list[str]
    """The schemas that the service reads and writes, such as `actum.event/1`."""
    joint_names: list[str]
    """The names of the fifteen joints, in the order of every list of joints."""
    model: str | None = None
    """The model that the classifier has loaded; null if there is none."""
    calibration: str | None = None
    """The calibration that the images carry; null if there is none."""
    host: str | None = None
    """The machine on which the service runs."""
    source: str | None = None
    """What a gateway reads: a simulated scene, a file or a camera; null for other services."""
    rate_hz: float | None = None
    """Frames per second that a gateway's source is set to deliver (Hz); null if unknown."""
    page: str | None = None
    """The address of the page that the service serves to browsers; null for other services."""
    commands: list[str] = Field([])
    """The names of the commands that the service accepts, such as `parameters`."""


class Truth(Message):
    """What the simulated scene really did: put at the start and at the end of each action."""

    SCHEMA = "actum.truth"
    kind: Literal["start", "end"]
    """The action's first frame (start) or last frame (end)."""
    segment_id: SegmentId
    """The segment's name."""
    agent: Annotated[int, Field(ge=1, lt=2**31)]
    """The number of the person who acts."""
    hand: Hand
    """The hand that acts."""
    action: Name
    """The action that is really done."""
    object_id: int
    """The number of the object that the action is done to; -1 for a pantomime."""
    object_name: Name
    """The object's name; empty for a pantomime."""
    displacement_m: FinitePoint | None
    """How far the object moved until the end, camera frame (m); null at the start and for a pantomime."""
