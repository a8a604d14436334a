"""A source whose camera is tilted, and whose skeletons say so."""

from collections.abc import Iterator

from actum.messages import Message, Skeleton
from actum.node import Source


class TiltedSource:
    """Another source, with which way is up (3,), in its camera's frame, put in every skeleton."""

    def __init__(self, source: Source, up_in_camera: list[float]) -> None:
        self._source, self._up_in_camera = source, up_in_camera
        self.name, self.paced, self.tally = source.name, source.paced, source.tally

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames."""
        for messages in self._source.frames():
            yield [self._told(message) for message in messages]

    def _told(self, message: Message) -> Message:
        up = {"up_in_camera": self._up_in_camera}
        return message.model_copy(update=up) if isinstance(message, Skeleton) else message
