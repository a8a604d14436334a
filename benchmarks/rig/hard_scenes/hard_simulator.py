"""The scene under conditions as a source: noisy skeletons, colour images and the truth."""

from collections.abc import Sequence
from dataclasses import replace

from actum.messages import Truth
from scene_simulator.everyday import Everyday
from scene_simulator.programme import Task
from scene_simulator.random_streams import random_stream
from scene_simulator.simulated_scene import SceneState
from scene_simulator.simulator import Simulator

from .conditions import Conditions
from .hard_renderer import HardRenderer
from .hard_scene import HardScene


class HardSimulator(Simulator):
    """A source of a scene under conditions; the same arguments give the same messages, bit for bit.

    The truth of a pantomime has the object id `NO_OBJECT`, an empty name and no displacement.

    Raises:
        ValueError: as of `Simulator`, or there is no room for a pantomime.
    """

    scene: HardScene

    def __init__(
        self,
        programme: Sequence[Task],
        actor_seed: int,
        seed: int,
        conditions: Conditions,
        *,
        image_hz: int = 15,
        tail_s: float = 3.0,
        everyday: Everyday | None = None,
    ) -> None:
        self._conditions = conditions
        super().__init__(programme, actor_seed, seed, image_hz=image_hz, tail_s=tail_s, everyday=everyday)

    def _make_scene(
        self, programme: Sequence[Task], actor_seed: int, seed: int, everyday: Everyday | None, _: tuple[float, float]
    ) -> HardScene:
        return HardScene(programme, actor_seed, seed, self._conditions, everyday)

    def _renderer(self) -> HardRenderer:
        return HardRenderer(self.scene, random_stream("image noise", *self._seeds))

    def _truth(self, state: SceneState, start: SceneState) -> Truth:
        if state.target is not None:
            return super()._truth(state, start)
        of_an_object = super()._truth(replace(state, target=0), start)
        return of_an_object.model_copy(update={"object_name": "", "displacement_m": None})
