"""The simulated scene over time: the ground truth of each frame, without noise."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Literal

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import draw_actor
from scene_simulator.everyday import Everyday, EverydayPerson
from scene_simulator.inverse_kinematics import Stance, fingertip, pose
from scene_simulator.noise import Sway
from scene_simulator.parameters import Parameters, load_parameters
from scene_simulator.programme import Task
from scene_simulator.random_streams import random_stream
from scene_simulator.timeline import Episode, acting, resetting, still
from scene_simulator.trial import Layout, Trial, draw_layout, draw_trial

Mark = Literal["start", "end"]
CLOSED = 0.5
"""Grip above which the hand holds the object."""


@dataclass(frozen=True)
class SceneState:
    """The ground truth of one frame, in the camera frame; n objects in the order of `Scene.items`.

    Attributes:
        joints_m: (15, 3).
        fingertip_m: (3,), tip of the acting hand's index finger.
        positions_m: (n, 3), the centres of the markers.
        yaw_rad: (n,), rotations of the objects about the vertical.
        riser_tops_m: (n, 3), the top of the riser under each object.
        grip: closure of the acting hand, 0 (open) to 1.
        pointing: extension of the index finger, 0 to 1.
        target: index of the object acted on; None in everyday doings.
        segment: number of the current repetition; None in a pause.
        mark: whether the repetition starts or ends with this frame.
        doing: the everyday doing, one of `doings.KINDS`; None in repetitions and pauses.
        in_view: whether the camera sees the person.
    """

    frame: int
    joints_m: Array
    fingertip_m: Array
    positions_m: Array
    yaw_rad: Array
    riser_tops_m: Array
    grip: float
    pointing: float
    target: int | None
    finger_overlap_m: float
    segment: int | None
    mark: Mark | None
    doing: str | None = None
    in_view: bool = True

    def camera_from_object(self, row: int) -> Array:
        """Return the pose (4, 4) of an object: x right and y up on the marked face, z out of it."""
        sin, cos = np.sin(self.yaw_rad[row]), np.cos(self.yaw_rad[row])
        transform = np.eye(4)
        transform[:3, :3] = [[cos, 0, sin], [0, -1, 0], [sin, 0, -cos]]
        transform[:3, 3] = self.positions_m[row]
        return transform


class Scene:
    """An actor at a table who does a programme with three marked objects; the same arguments give the same scene.

    With `everyday`, the actor does other things between the actions, or, with an empty programme, nothing else. The
    table, with all that belongs to it, stands by `place_m` further to the camera's right and further away.

    Raises:
        ValueError: the programme is empty, and there are no everyday doings.
    """

    def __init__(
        self,
        programme: Sequence[Task],
        actor_seed: int,
        seed: int,
        parameters: Parameters | None = None,
        everyday: Everyday | None = None,
        place_m: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        if not programme and everyday is None:
            raise ValueError(
                "the simulated person has nothing to do: give at least one task in the argument 'programme', or "
                "background activities in the argument 'everyday'"
            )
        self.programme: Sequence[Task] = tuple(programme)
        self.parameters = (parameters or load_parameters()).moved(*place_m)
        self.items = self.parameters.objects.items
        actor = draw_actor(self.parameters.actor, actor_seed)
        self.actor = replace(actor, stand_x_m=actor.stand_x_m + place_m[0])
        self.places_x_m = random_stream("places", seed).permutation(self.parameters.objects.place_x_m)
        self.seeds = (actor_seed, seed)
        self.trials = tuple(self._trial(number, task) for number, task in enumerate(programme))
        self._least_s = everyday.least_s if everyday else 0.0
        self._person = EverydayPerson(everyday, self.parameters, self.actor, self.seeds) if everyday else None

    def states(self, tail_s: float = 3.0) -> Iterator[SceneState]:
        """Yield the state of every frame: a lead-in, the programme with its pauses, and `tail_s` of return to rest."""
        sway = Sway(random_stream("sway", *self.seeds), self.parameters.sway)
        frame = 0
        for episode in self._episodes(tail_s):
            yield from self._posed(episode, frame, sway)
            frame += len(episode)

    def _trial(self, number: int, task: Task) -> Trial:
        rng = random_stream("trial", *self.seeds, number)
        return draw_trial(self.parameters, self.actor, task, self.places_x_m, rng)

    def _layouts(self) -> list[Layout]:
        """Return the layout of each task; without tasks, one for the whole scene."""
        if self.trials:
            return [trial.layout for trial in self.trials]
        rng = random_stream("layout", *self.seeds)
        return [draw_layout(self.parameters, self.actor, "", self.places_x_m, None, rng)]

    def _episodes(self, tail_s: float) -> Iterator[Episode]:
        """Yield the programme, and then everyday doings until the scene is as long as it has to be."""
        frames = 0
        for episode in self._programme(tail_s):
            frames += len(episode)
            yield episode
        layout = self._layouts()[-1]
        pauses = (self._doings(number, layout) for number in count(len(self.trials)))
        while frames < self._least_s * self.parameters.camera.frame_rate_hz:
            for episode in next(pauses):
                frames += len(episode)
                yield episode

    def _programme(self, tail_s: float) -> Iterator[Episode]:
        layouts, pause = self._layouts(), self.parameters.pause
        yield still(self.parameters, layouts[0], pause.lead_in_s)
        following = [*layouts[1:], layouts[-1]]
        pauses = [*(trial.pause_s for trial in self.trials[:-1]), tail_s]
        for number, trial in enumerate(self.trials):
            yield from self._doings(number, trial.layout)
            done = self._acting(trial, number)
            yield done
            return_s = pause.return_share * trial.pause_s
            yield from self.pause(done, following[number], pauses[number], return_s)

    def pause(self, done: Episode, following: Layout, seconds: float, return_s: float) -> Iterator[Episode]:
        """Yield the pause after an action: hands and objects move to the layout of what follows."""
        yield resetting(self.parameters, done, following, seconds, return_s)

    def _acting(self, trial: Trial, number: int) -> Episode:
        """Return the episode of one repetition, done with the actor's preferred hand."""
        return acting(self.parameters, trial, number, self.actor.column)

    def _doings(self, number: int, layout: Layout) -> Sequence[Episode]:
        """Return what the person does before the task of a number: nothing without everyday doings."""
        return [] if self._person is None else self._person.pause(number, layout)

    def _posed(self, episode: Episode, first: int, sway: Sway) -> Iterator[SceneState]:
        """Yield the states of an episode, with the swaying person's joints."""
        shift = sway.at(np.arange(first, first + len(episode)) / self.parameters.camera.frame_rate_hz)
        pelvis = episode.pelvis_m + np.insert(shift[:, :2], 1, 0.0, axis=1)
        lean = self.actor.lean_rad + shift[:, 2] + episode.lean_rad
        stance = Stance(pelvis, episode.heading_rad, lean, episode.twist_rad, episode.reaching, episode.legs_rad)
        in_view = np.abs(pelvis[:, 0]) < self.parameters.camera.half_view * pelvis[:, 2]
        joints = pose(self.actor, stance, episode.hands_m)
        tips = fingertip(self.actor, joints)
        for i in range(len(episode)):
            yield SceneState(
                frame=first + i,
                joints_m=joints[i],
                fingertip_m=tips[i],
                positions_m=episode.positions_m[i],
                yaw_rad=episode.yaw_rad[i],
                riser_tops_m=episode.riser_tops_m[i],
                grip=float(episode.grip[i]),
                pointing=float(episode.pointing[i]),
                target=None if episode.trial is None else episode.trial.target,
                finger_overlap_m=0.0 if episode.trial is None else episode.trial.finger_overlap_m,
                segment=episode.segment,
                mark=_mark(episode, i),
                doing=episode.doings[i],
                in_view=bool(in_view[i]),
            )


def _mark(episode: Episode, index: int) -> Mark | None:
    if episode.segment is None:
        return None
    return "start" if index == 0 else "end" if index == len(episode) - 1 else None
