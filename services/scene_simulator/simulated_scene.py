"""The scene over time: what is true in each frame, without noise."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Stance, draw_actor, fingertip, pose
from scene_simulator.chance import stream
from scene_simulator.conditions import PLAIN, Conditions
from scene_simulator.noise import Sway
from scene_simulator.pantomime import draw_pantomime
from scene_simulator.parameters import Parameters, load_parameters
from scene_simulator.programme import Sample
from scene_simulator.timeline import Clip, acting, resetting, still
from scene_simulator.trial import Trial, draw_trial

Mark = Literal["start", "end"]
CLOSED = 0.5


@dataclass(frozen=True)
class SceneState:
    """What is true in one frame, camera frame; rows of the objects in the order of `Scene.items`.

    `joints_m` (15, 3); `positions_m` (n, 3) the marker centres, `yaw_rad` (n,), `riser_tops_m` (n, 3) the top of
    the riser at each object's place. `grip` (0 to 1) is how far the hand is closed on object `target` (None: on
    nothing), `pointing` how far the index finger is stretched. `segment` numbers the repetition going on, `mark` says
    that it starts or ends with this frame.
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

    @property
    def held(self) -> int | None:
        """The row of the object in the hand, or None."""
        return self.target if self.segment is not None and self.grip > CLOSED else None

    def camera_from_object(self, row: int) -> Array:
        """Return the pose (4, 4) of an object: x right and y up on the marked face, z out of it."""
        sin, cos = np.sin(self.yaw_rad[row]), np.cos(self.yaw_rad[row])
        transform = np.eye(4)
        transform[:3, :3] = [[cos, 0, sin], [0, -1, 0], [sin, 0, -cos]]
        transform[:3, 3] = self.positions_m[row]
        return transform


class Scene:
    """An actor at a table with three marked objects, doing a programme; the same arguments, the same scene.

    Raises:
        ValueError: the programme is empty.
    """

    def __init__(
        self,
        programme: Sequence[Sample],
        actor_seed: int,
        seed: int,
        parameters: Parameters | None = None,
        conditions: Conditions = PLAIN,
    ) -> None:
        if not programme:
            raise ValueError("the programme is empty: give at least one sample")
        self.conditions = conditions
        self.parameters = conditions.arranged(parameters or load_parameters())
        self.items = self.parameters.objects.items
        self.actor = draw_actor(self.parameters.actor, actor_seed)
        self.places_x_m = stream("places", seed).permutation(self.parameters.objects.place_x_m)
        self.seeds = (actor_seed, seed)
        self.trials = tuple(self._trial(number, sample) for number, sample in enumerate(programme))

    def states(self, tail_s: float = 3.0) -> Iterator[SceneState]:
        """Yield every frame: a lead-in, the programme with its pauses, and `tail_s` of returning to rest."""
        sway = Sway(stream("sway", *self.seeds), self.parameters.sway)
        frame = 0
        for clip in self._clips(tail_s):
            yield from self._posed(clip, frame, sway)
            frame += len(clip)

    def _trial(self, number: int, sample: Sample) -> Trial:
        rng = stream("trial", *self.seeds, number)
        draw = draw_pantomime if sample.is_pantomime else draw_trial
        return draw(self.parameters, self.actor, sample, self.places_x_m, rng)

    def _clips(self, tail_s: float) -> Iterator[Clip]:
        yield still(self.parameters, self.trials[0], self.parameters.pause.lead_in_s)
        following = [*self.trials[1:], self.trials[-1]]
        pauses = [*(trial.pause_s for trial in self.trials[:-1]), tail_s]
        column = 0 if self.actor.hand == "left" else 1
        for number, trial in enumerate(self.trials):
            done = acting(self.parameters, trial, number, column)
            yield done
            yield resetting(self.parameters, done, following[number], pauses[number])

    def _posed(self, clip: Clip, first: int, sway: Sway) -> Iterator[SceneState]:
        """Work out the person's posture and yield the clip's frames."""
        shift = sway.at(np.arange(first, first + len(clip)) / self.parameters.camera.frame_rate_hz)
        pelvis = clip.pelvis_m + np.insert(shift[:, :2], 1, 0.0, axis=1)
        stance = Stance(pelvis, clip.heading_rad, self.actor.lean_rad + shift[:, 2])
        joints = pose(self.actor, stance, clip.hands_m)
        tips = fingertip(self.actor, joints)
        for i in range(len(clip)):
            yield SceneState(
                frame=first + i,
                joints_m=joints[i],
                fingertip_m=tips[i],
                positions_m=clip.positions_m[i],
                yaw_rad=clip.yaw_rad[i],
                riser_tops_m=clip.riser_tops_m[i],
                grip=float(clip.grip[i]),
                pointing=float(clip.pointing[i]),
                target=clip.trial.target,
                finger_overlap_m=clip.trial.finger_overlap_m,
                segment=clip.segment,
                mark=_mark(clip, i),
            )


def _mark(clip: Clip, index: int) -> Mark | None:
    if clip.segment is None:
        return None
    return "start" if index == 0 else "end" if index == len(clip) - 1 else None
