"""The types of fields, and the header that every message has."""

import math
from functools import cache
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    FiniteFloat,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from actum.core import steps

Stamp = Annotated[int, Field(ge=0, lt=2**62)]
Seq = Annotated[int, Field(ge=0, lt=2**40)]
Count = Annotated[int, Field(ge=0, lt=2**62)]
AgentId = Annotated[int, Field(ge=0, lt=2**31)]
Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Joint = Point | None


def _validated(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
    """Have pydantic validate a value, as the compiled step does with what is not valid as it is."""
    return validate(value)


Joints = Annotated[
    list[Joint],
    Field(min_length=15, max_length=15),
    WrapValidator(_validated if steps is None else steps.plain_joints_or),
]
FinitePoint = Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[FiniteFloat], Field(min_length=4, max_length=4)]
Transform = Annotated[list[FiniteFloat], Field(min_length=16, max_length=16)]
Intrinsics = Annotated[list[FiniteFloat], Field(min_length=9, max_length=9)]
SegmentId = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, Field(max_length=200)]
Reason = Annotated[str, Field(max_length=1000)]
Deviation = Annotated[FiniteFloat, Field(ge=0)]
Hand = Literal["left", "right"]

MOST_AGENTS = 64
"""Most people in one message: a camera sees fewer, and services keep memory for each."""
MOST_OBJECTS = 128
"""Most objects in one message, for the same reason."""
MOST_ACTIONS = 1000
"""Most actions that one message gives an activity of."""
LARGEST_SIDE_PX = 65_535
"""Longest side of an image (px): what a JPEG can have. The tracker decodes less."""
_SHORTEST = 1e-3
"""A direction vector shorter than this, or longer than its reciprocal, is taken for an error."""


def _nonzero(direction: list[float]) -> list[float]:
    if not _SHORTEST < (length := math.hypot(*direction)) < 1 / _SHORTEST:
        raise ValueError(
            f"the vector {direction} has a length of {length:g}, which gives no direction: give a unit vector such as "
            "[0, -1, 0], which is up for a level camera"
        )
    return direction


Direction = Annotated[FinitePoint, AfterValidator(_nonzero)]


class Message(BaseModel):
    """What every message carries."""

    model_config = ConfigDict(
        frozen=True, extra="ignore", strict=True, ser_json_inf_nan="constants", use_attribute_docstrings=True
    )
    SCHEMA: ClassVar[str]
    VERSION: ClassVar[int] = 1

    stamp_ns: Stamp
    """Capture time on the sensor's clock, in nanoseconds. Messages computed from a frame carry the frame's stamp
    unchanged."""
    seq: Seq | None = None
    """The message's number on its key, from 0 when the publishing process starts; null until the runtime sets it."""
    sensor: str
    """The sensor's name: the part of the key after `actum/`."""
    valid: bool = True
    """Whether the content can be used; if not, `reason` says why."""
    reason: Reason | None = None
    """Why the message is not valid; null if it is valid."""

    @classmethod
    def of_checked(cls, **fields: Any) -> Self:
        """Build a message of a step's own results without checking them again: they are of the fields' types already.

        It is the message that the class makes of the same fields. All lists and maps have to be given, and are not
        copied: nobody may change them afterwards.
        """
        message = cls.__new__(cls)
        object.__setattr__(message, "__dict__", {**_defaults(cls), **fields})
        object.__setattr__(message, "__pydantic_fields_set__", set(fields))
        object.__setattr__(message, "__pydantic_extra__", None)
        object.__setattr__(message, "__pydantic_private__", None)
        return message


@cache
def _defaults(kind: type[Message]) -> dict[str, Any]:
    """Return a message's fields in order with their default values; None for a list or map: messages would share it."""
    defaults = {name: field.get_default(call_default_factory=True) for name, field in kind.model_fields.items()}
    return {name: None if isinstance(default, (list, dict)) else default for name, default in defaults.items()}


class Model(BaseModel):
    """A part of a message."""

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True, use_attribute_docstrings=True)
