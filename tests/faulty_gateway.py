"""A gateway with one fault, as a process: `python tests/faulty_gateway.py FAULT`.

Its source says that it gives 30 frames a second. `slow` gives 12, `frozen` repeats one, `still` has stamps that do not
rise, `stopped` puts no image after the first five.
"""

import sys
import time
from collections.abc import Iterator

from actum.messages import Image, Message, Skeleton
from actum.node import SECOND_NS, Counters
from actum.runtime import run_source
from actum.settings import ServiceSettings
from empty_messages import image
from people import STANDING, skeleton

SAID_HZ = 30
SLOW_HZ = 12
IMAGES = 5


class FaultyGateway:
    """Puts somebody who stands, and an image of it with each frame."""

    name = "sensor_gateway"
    paced = False

    def __init__(self, fault: str) -> None:
        self.counters = Counters(details={"source": f"gateway that is {fault}", "rate_hz": f"{SAID_HZ}"})
        self._fault = fault

    def frames(self) -> Iterator[list[Message]]:
        number = 0
        while True:
            time.sleep(1 / (SLOW_HZ if self._fault == "slow" else SAID_HZ))
            yield [*self._image(number), self._skeleton(number)]
            number += 1

    def _skeleton(self, number: int) -> Skeleton:
        stamp_ns = SECOND_NS if self._fault == "still" else time.monotonic_ns()
        return skeleton(stamp_ns, STANDING if self._fault == "frozen" else STANDING + 0.001 * (number % 50))

    def _image(self, number: int) -> list[Image]:
        if self._fault == "stopped" and number >= IMAGES:
            return []
        data = b"picture" if self._fault == "frozen" else f"picture {number}".encode()
        return [image(time.monotonic_ns()).model_copy(update={"data": data})]


if __name__ == "__main__":
    fault = sys.argv.pop()
    run_source(ServiceSettings, lambda _settings: FaultyGateway(fault))
