"""A source whose messages are changed one by one before they are put."""

from collections.abc import Callable, Iterator

from actum.calibration import Calibration
from actum.messages import Image, Message, Skeleton
from actum.node import Counters, Source

Mapping = Callable[[Message], Message | None]
"""Returns the message to put in place of a message; None drops it."""
LONGEST_SESSION = 150
"""Characters kept of a recorded session id, so that it fits its field together with the run's id."""


class MappedSource:
    """Another source, a function applied to each of its messages."""

    def __init__(self, source: Source, mapping: Mapping) -> None:
        self._source, self._mapping = source, mapping
        self.name, self.paced, self.counters = source.name, source.paced, source.counters

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames, mapped."""
        for messages in self._source.frames():
            yield [mapped for message in messages if (mapped := self._mapping(message)) is not None]


def with_up(up_in_camera: list[float]) -> Mapping:
    """Set the up direction (3,) of skeletons, in the camera frame."""
    up = {"up_in_camera": up_in_camera}
    return lambda message: message.model_copy(update=up) if isinstance(message, Skeleton) else message


def without_image(message: Message) -> Message | None:
    """Drop images."""
    return None if isinstance(message, Image) else message


def with_session_of(run: str) -> Mapping:
    """Add this run to the session ids of skeletons and images: stamps start again when a file is played again."""

    def mapping(message: Message) -> Message:
        if not isinstance(message, Skeleton | Image):
            return message
        return message.model_copy(update={"session_id": f"{message.session_id[:LONGEST_SESSION]}.{run}"})

    return mapping


def with_calibration(calibration: Calibration, counters: Counters) -> Mapping:
    """Replace the intrinsics and `skeleton_from_image` of colour images by those of a calibration file.

    An image whose size differs from the calibrated one is counted and marked invalid.
    """

    def mapping(message: Message) -> Message:
        if not isinstance(message, Image) or message.format == "depth16_mm":
            return message
        width, height = calibration.image_size
        if (message.width, message.height) == (width, height):
            return message.model_copy(update=calibration.image_fields())
        reason = f"image_size_mismatch: {message.width}x{message.height}, calibrated for {width}x{height}"
        counters.reject("image_size_mismatch", reason)
        return message.model_copy(update={"valid": False, "reason": reason})

    return mapping
