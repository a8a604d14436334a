"""A source whose colour images say what a calibration file says of their camera."""

from collections.abc import Iterator

from actum.calibration import Calibration
from actum.messages import Image, Message
from actum.node import Source


class CalibratedSource:
    """Another source, its images' intrinsics and `skeleton_from_image` replaced by those of a calibration."""

    def __init__(self, source: Source, calibration: Calibration) -> None:
        self._source = source
        self._calibration = calibration
        self.name, self.paced, self.counters = source.name, source.paced, source.counters
        self.counters.details["calibration"] = calibration.id

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames; an image of another size than was calibrated is counted and marked invalid."""
        for messages in self._source.frames():
            yield [self._calibrated(message) for message in messages]

    def _calibrated(self, message: Message) -> Message:
        if not isinstance(message, Image) or message.format == "depth16_mm":
            return message
        if (message.width, message.height) == self._calibration.image_size:
            return message.model_copy(update=self._calibration.image_fields())
        width, height = self._calibration.image_size
        reason = f"image_size_mismatch: {message.width}x{message.height}, calibrated for {width}x{height}"
        self.counters.reject("image_size_mismatch", reason)
        return message.model_copy(update={"valid": False, "reason": reason})
