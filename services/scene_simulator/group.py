"""Several people side by side in one stream of skeletons, each with a programme of their own."""

from collections.abc import Iterator, Sequence
from itertools import zip_longest

from actum.messages import Message, Skeleton
from actum.node import Counters
from scene_simulator.everyday import Everyday
from scene_simulator.programme import Task
from scene_simulator.simulator import GATEWAY, Simulator

MOST_PEOPLE = 4
"""More do not fit side by side into the view."""
SPACING_M = 0.8
"""Distance between two people: with elbows out each takes 0.7 m."""
AWAY_M = 0.9
"""How much further than usual from the camera they stand: it then sees all four, and their arms."""


class Group:
    """A source of skeletons of one to four people, numbered from 1 from the camera's left, and of their truths.

    Each has a table and three objects of their own. Where there are images, they show the one in the middle alone,
    with table and objects: what a scene of one person costs to draw. Person k is the actor of
    seed `actor_seed` + k and does `programmes[k]`; whoever has done it leaves, and the stream ends with the last. One
    person's joints are the same whatever the others do. The same arguments give the same messages, bit for bit.

    Raises:
        ValueError: there are no programmes or more than four, or one is empty without everyday doings.
    """

    name = GATEWAY
    paced = True

    def __init__(
        self,
        programmes: Sequence[Sequence[Task]],
        actor_seed: int = 0,
        seed: int = 0,
        *,
        everyday: Everyday | None = None,
        sensor: str = "kinect0",
        start_ns: int = 0,
        session_id: str | None = None,
        image_hz: int = 0,
    ) -> None:
        if not 1 <= len(programmes) <= MOST_PEOPLE:
            raise ValueError(f"the simulated scene cannot show {len(programmes)} people: use 1 to {MOST_PEOPLE} people")
        self.counters = Counters()
        middle = (len(programmes) - 1) / 2
        self.simulators = [
            Simulator(
                programme,
                actor_seed + k,
                seed,
                sensor=sensor,
                image_hz=image_hz if k == len(programmes) // 2 else 0,
                start_ns=start_ns,
                session_id=session_id or f"simulator-{actor_seed}-{seed}",
                everyday=everyday,
                agent=k + 1,
                place_m=((k - middle) * SPACING_M, AWAY_M),
            )
            for k, programme in enumerate(programmes)
        ]

    def frames(self) -> Iterator[list[Message]]:
        """Yield the messages of each frame: the truths of all people, and one skeleton message."""
        for frames in zip_longest(*(simulator.frames() for simulator in self.simulators), fillvalue=()):
            messages = [message for frame in frames for message in frame]
            skeletons = [message for message in messages if isinstance(message, Skeleton)]
            agents = [agent for skeleton in skeletons for agent in skeleton.agents]
            others = [message for message in messages if not isinstance(message, Skeleton)]
            yield [*others, skeletons[0].model_copy(update={"agents": agents})]
