"""The simulator that the settings describe: one scene, or an endless sequence of scenes."""

from collections.abc import Iterator

from actum.messages import Message
from actum.node import SECOND_NS, Counters, Source
from scene_simulator.driven_simulator import DrivenSimulator
from scene_simulator.everyday import chosen
from scene_simulator.group import Group
from scene_simulator.parameters import load_parameters
from scene_simulator.programme import balanced_programme
from scene_simulator.settings import Settings
from scene_simulator.simulator import GATEWAY, Simulator, session_of

REPETITIONS = 4
"""Repetitions of each action in one scene of an endless sequence; the next scene has another seed."""
DESCRIPTION = "simulated scene, no camera"


def simulator_of(settings: Settings, start_ns: int) -> Source:
    """Build the source; its stamps begin at `start_ns`."""
    source: Source
    if settings.driven:
        source = DrivenSimulator(settings, start_ns)
    elif settings.repetitions == 0:
        source = EndlessSimulator(settings, start_ns)
    else:
        source = _simulator(settings, start_ns, session_of(start_ns))
    source.counters.details["source"] = DESCRIPTION
    source.counters.details["rate_hz"] = f"{load_parameters().camera.frame_rate_hz:g}"
    return source


class EndlessSimulator:
    """An endless sequence of simulated scenes as one stream."""

    name = GATEWAY
    paced = True

    def __init__(self, settings: Settings, start_ns: int) -> None:
        self.counters = Counters()
        self._settings = settings
        self._start_ns = start_ns

    def frames(self) -> Iterator[list[Message]]:
        """Yield frames for ever."""
        start_ns, seed = self._start_ns, self._settings.seed
        while True:
            settings = self._settings.model_copy(update={"repetitions": REPETITIONS, "seed": seed})
            for messages in _simulator(settings, start_ns, session_of(self._start_ns)).frames():
                yield messages
                newest_ns = messages[0].stamp_ns
            start_ns, seed = newest_ns + SECOND_NS, seed + 1


def _simulator(settings: Settings, start_ns: int, session_id: str) -> Source:
    repetitions = 0 if settings.everyday == "only" else settings.repetitions
    actors = range(settings.actor, settings.actor + settings.actors)
    programmes = [balanced_programme(repetitions, settings.seed, actor) for actor in actors]
    everyday = chosen(settings.everyday, settings.minutes, settings.pauses)
    if len(programmes) > 1:
        return Group(
            programmes,
            actor_seed=settings.actor,
            seed=settings.seed,
            everyday=everyday,
            sensor=settings.sensor,
            start_ns=start_ns,
            session_id=session_id,
        )
    return Simulator(
        programmes[0],
        actor_seed=settings.actor,
        seed=settings.seed,
        sensor=settings.sensor,
        image_hz=settings.image_hz,
        start_ns=start_ns,
        session_id=session_id,
        everyday=everyday,
    )
