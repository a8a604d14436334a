"""Start and end marks as JSON in a String."""

import pydantic_core
from pydantic import ValidationError

from actum.messages import Segment
from ros2_bridge.message_types import STRING, NotThatTypeError, from_cdr

FIELDS = ("kind", "segment_id", "stamp_ns", "agent", "hand", "label")
"""What a mark may hold; the other fields of a segment message are filled in here."""
MOST_BYTES = 10_000
"""A longer payload is no mark (bytes)."""


class BadMarkError(ValueError):
    """A payload that is no mark; the text says why."""


def segment_of(payload: bytes, sensor: str) -> Segment:
    """Return the segment message of a String's bytes.

    Raises:
        BadMarkError: they are no String, or that holds no mark.
    """
    if len(payload) > MOST_BYTES:
        raise BadMarkError(
            f"a message that marks an action has {len(payload)} bytes; at most {MOST_BYTES} bytes are allowed: send a "
            "shorter message"
        )
    try:
        fields = pydantic_core.from_json(from_cdr(payload, STRING).data, allow_inf_nan=False)
    except NotThatTypeError as error:
        raise BadMarkError(
            f"a message that marks an action is not a std_msgs/String ({error}): send a JSON object as the data of a "
            "std_msgs/String"
        ) from None
    except ValueError as error:
        raise BadMarkError(
            f"a message that marks an action is not JSON ({error}): send a JSON object as the data of a std_msgs/String"
        ) from None
    if not isinstance(fields, dict):
        raise BadMarkError(
            f"a message that marks an action must be a JSON object with some of the fields {', '.join(FIELDS)}; this "
            f"message is a JSON {type(fields).__name__}"
        )
    unknown = [name for name in fields if name not in FIELDS]
    if unknown:
        raise BadMarkError(
            f"{unknown[0]!r} is not a field of a message that marks an action: use one or more of {', '.join(FIELDS)}"
        )
    try:
        return Segment.model_validate({**fields, "sensor": sensor})
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        raise BadMarkError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from None
