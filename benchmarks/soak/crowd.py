"""`python -m benchmarks.soak.crowd`: the sensor of the soak, four people at 30 frames a second, images and marks."""

import time
from collections.abc import Iterable, Iterator

from actum.messages import Message, Segment, Truth
from actum.node import SECOND_NS, Counters
from actum.runtime import run_source
from actum_command.scene_marks import mark_of
from scene_simulator.group import MOST_PEOPLE, Group
from scene_simulator.programme import balanced_programme
from scene_simulator.settings import Settings
from scene_simulator.simulator import GATEWAY

REPETITIONS = 4
"""Of each action in one scene; the next one follows."""
SEEN = MOST_PEOPLE // 2
"""Index of the person whom the images show. They do each action once more than the others, so that no scene goes on
without images: a segment without objects would be rejected."""


class Crowd:
    """An endless sequence of scenes of four people, as one stream."""

    name = GATEWAY
    paced = True

    def __init__(self, settings: Settings) -> None:
        self.counters = Counters()
        self._settings = settings

    def frames(self) -> Iterator[list[Message]]:
        """Yield frames for ever."""
        start_ns, seed = time.time_ns(), self._settings.seed
        session = f"crowd-{start_ns}"
        while True:
            counts = [REPETITIONS + (actor == SEEN) for actor in range(MOST_PEOPLE)]
            programmes = [balanced_programme(count, seed, actor) for actor, count in enumerate(counts)]
            sensor, hz = self._settings.sensor, self._settings.image_hz
            group = Group(programmes, 0, seed, sensor=sensor, start_ns=start_ns, session_id=session, image_hz=hz)
            for messages in group.frames():
                yield [*messages, *marks(messages)]
                newest_ns = messages[0].stamp_ns
            start_ns, seed = newest_ns + SECOND_NS, seed + 1


def marks(messages: Iterable[Message]) -> list[Segment]:
    """Return the marks of a frame, which say who acts: four people act at once."""
    truths = [message for message in messages if isinstance(message, Truth)]
    return [mark_of(truth).model_copy(update={"agent": truth.agent}) for truth in truths]


if __name__ == "__main__":
    run_source(Settings, Crowd)
