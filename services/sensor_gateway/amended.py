"""A source whose messages say something more, or something else, than those of the source itself."""

from collections.abc import Callable, Iterator

from actum.messages import Image, Message, Skeleton
from actum.node import Source

Amend = Callable[[Message], Message | None]
"""What is put in place of a message; None for nothing."""
LONGEST_SESSION = 150
"""Characters kept of a recorded session's name: with the run's it has to fit its field."""


class AmendedSource:
    """Another source, each of its messages amended."""

    def __init__(self, source: Source, amend: Amend) -> None:
        self._source, self._amend = source, amend
        self.name, self.paced, self.counters = source.name, source.paced, source.counters

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames."""
        for messages in self._source.frames():
            yield [amended for message in messages if (amended := self._amend(message)) is not None]


def tilted(up_in_camera: list[float]) -> Amend:
    """Let skeletons say which way is up (3,), in the camera's frame."""
    up = {"up_in_camera": up_in_camera}
    return lambda message: message.model_copy(update=up) if isinstance(message, Skeleton) else message


def without_image(message: Message) -> Message | None:
    """Drop images."""
    return None if isinstance(message, Image) else message


def played_anew(run: str) -> Amend:
    """Give what comes from files a session of this run: played again, its stamps begin again."""

    def amend(message: Message) -> Message:
        if not isinstance(message, Skeleton | Image):
            return message
        return message.model_copy(update={"session_id": f"{message.session_id[:LONGEST_SESSION]}.{run}"})

    return amend
