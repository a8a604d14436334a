"""Marks: where a segment starts and ends, and what is done in it."""

from typing import Annotated, Any, Literal, TypeGuard

from pydantic import AfterValidator, Field

from actum.messages.base import Hand, Message, Name, SegmentId, Stamp

MANUAL = "manual"
"""The origin of marks that a person puts."""
SIMULATOR = "simulator"
"""The origin of the simulated scene's marks."""
REPLAY = "replay"
"""The origin of the marks of a recording that is played."""
AUTO = "auto"
"""The origin of the marks that the classifier puts itself, where it has found an action that nobody marked."""
CUT = "cut"
"""The origin of marks that `actum record --times` or `actum label cut` cut out of a recording."""


NONE = "none"
"""The label of segments that are like an action and are none: models learn from them that they are not."""


def is_action(label: str | None) -> TypeGuard[str]:
    """Tell whether a segment's label names an action."""
    return label is not None and label != NONE


class Segment(Message):
    """A start or end mark; anyone may put one with just `kind` and `segment_id`."""

    SCHEMA = "actum.segment"
    stamp_ns: Stamp | None = None  # type: ignore[assignment]
    """When the action starts or ends, on the sensor's clock (ns); null means now."""
    kind: Literal["start", "end"]
    """Whether this mark is the start or the end of the action."""
    segment_id: SegmentId
    """The segment's name: the same in its start and end mark, new for each action."""
    agent: Annotated[int, Field(ge=1, lt=2**31)] | None = None
    """The number of the person who acts; null if the classifier is to find out."""
    hand: Hand | None = None
    """The hand that acts; null if unknown."""
    label: Annotated[Name | None, AfterValidator(lambda text: text or None)] = None
    """The action that is done, for training; recognition never uses the label. The label `none` says that the segment
    is like an action but is not one. An empty label is read as null."""
    origin: Name | None = None
    """Who published the mark: manual, a person at a switch; simulator, the simulated scene; replay, a recording that is
    played; auto, the classifier, for a segment that it found and that it alone answers; cut, `actum record --times` or
    `actum label cut`; null, another program."""


def segment_marks(
    start_ns: int,
    end_ns: int,
    sensor: str,
    segment_id: str,
    label: str,
    agent: int | None = None,
    hand: Hand | None = None,
    origin: str | None = None,
) -> list[Segment]:
    """Return the start and the end mark of a segment; the start carries its label."""
    common: dict[str, Any] = {
        "sensor": sensor, "segment_id": segment_id, "agent": agent, "hand": hand, "origin": origin,
    }  # fmt: skip
    return [
        Segment(stamp_ns=start_ns, kind="start", label=label, **common),
        Segment(stamp_ns=end_ns, kind="end", **common),
    ]
