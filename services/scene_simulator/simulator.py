"""The simulated scene as a source: noisy skeletons, colour images and the truth, stamped and in order."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from actum.messages import SIMULATOR, Agent, Image, Message, Segment, Skeleton, Truth
from actum.node import SECOND_NS, Counters, Source
from scene_simulator.everyday import Everyday
from scene_simulator.noise import SkeletonNoise
from scene_simulator.programme import Task
from scene_simulator.random_streams import random_stream
from scene_simulator.simulated_scene import Scene, SceneState

if TYPE_CHECKING:
    from scene_simulator.render import Renderer

AGENT = 1
"""Number of the person, who usually is the only one."""
GATEWAY = "sensor_gateway"
"""Name of the service that the simulator stands in for: consumers need not know which of the two a sensor has."""


class Simulator:
    """A source of skeletons, images and truth; the same arguments give the same messages, bit for bit.

    `image_hz` must divide the frame rate; 0 means no images. The first and the last frame of each action have a
    `Truth`; the last one contains the object's displacement in the camera frame. `everyday` doings have no truth; while
    the person is out of view the skeletons have no agent. The glass and the phone of everyday doings are not drawn.

    Raises:
        ValueError: the programme is empty without `everyday`, or `image_hz` does not divide the frame rate.
    """

    name = GATEWAY
    paced = True

    def __init__(  # noqa: PLR0913 - the scene, and how it is published
        self,
        programme: Sequence[Task],
        actor_seed: int = 0,
        seed: int = 0,
        *,
        sensor: str = "kinect0",
        image_hz: int = 15,
        start_ns: int = 0,
        session_id: str | None = None,
        tail_s: float = 3.0,
        everyday: Everyday | None = None,
        agent: int = AGENT,
        place_m: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        self.counters = Counters()
        self.scene = self._make_scene(programme, actor_seed, seed, everyday, place_m)
        self._rate_hz = self.scene.parameters.camera.frame_rate_hz
        if image_hz and (image_hz < 0 or self._rate_hz % image_hz):
            raise ValueError(
                f"image_hz is {image_hz}, which does not divide the frame rate of {self._rate_hz} Hz: use a divisor "
                "of the frame rate"
            )
        self._frames_per_image = self._rate_hz // image_hz if image_hz else 0
        self._seeds = (actor_seed, seed)
        self._agent = agent
        self._sensor, self._start_ns, self._tail_s = sensor, start_ns, tail_s
        self._session_id = session_id or f"simulator-{actor_seed}-{seed}"

    def frames(self) -> Iterator[list[Message]]:
        """Yield the messages of each frame, from the beginning of the scene."""
        noise = SkeletonNoise(
            random_stream("skeleton noise", *self._seeds),
            self.scene.parameters.noise,
            self.scene.actor.noise_scale,
            self._rate_hz,
        )
        renderer = self._renderer() if self._frames_per_image else None
        start = None
        for state in self.scene.states(self._tail_s):
            messages: list[Message] = [self._skeleton(state, noise)]
            if state.mark == "start":
                start = state
            if state.mark is not None and start is not None:
                messages.insert(0, self._truth(state, start))
            if renderer is not None and state.frame % self._frames_per_image == 0:
                messages.append(self._image(state, renderer))
            yield messages

    def stamp_ns(self, frame: int) -> int:
        """Return a frame's capture time: exact to the nanosecond, without drift."""
        return self._start_ns + (frame * SECOND_NS + self._rate_hz // 2) // self._rate_hz

    def segment_id(self, number: int) -> str:
        """Return the segment id of a repetition by its number; the id does not reveal the action."""
        actor_seed, seed = self._seeds
        return f"s{actor_seed}-{seed}-{number:03d}"

    def _make_scene(
        self,
        programme: Sequence[Task],
        actor_seed: int,
        seed: int,
        everyday: Everyday | None,
        place_m: tuple[float, float],
    ) -> Scene:
        return Scene(programme, actor_seed, seed, None, everyday, place_m)

    def _renderer(self) -> "Renderer":
        from scene_simulator.render import Renderer  # only images need OpenCV

        return Renderer(self.scene, random_stream("image noise", *self._seeds))

    def _skeleton(self, state: SceneState, noise: SkeletonNoise) -> Skeleton:
        joints, confidence = noise.measure(state.joints_m)
        agent = Agent(agent=self._agent, joints=joints.tolist(), confidence=confidence)
        return Skeleton(
            stamp_ns=self.stamp_ns(state.frame),
            sensor=self._sensor,
            agents=[agent] if state.in_view else [],
            session_id=self._session_id,
        )

    def _truth(self, state: SceneState, start: SceneState) -> Truth:
        assert state.segment is not None and state.mark is not None and state.target is not None
        task = self.scene.programme[state.segment]
        moved = state.positions_m[state.target] - start.positions_m[state.target]
        return Truth(
            stamp_ns=self.stamp_ns(state.frame),
            sensor=self._sensor,
            kind=state.mark,
            segment_id=self.segment_id(state.segment),
            agent=self._agent,
            hand=self.scene.actor.hand,
            action=task.action,
            object_id=task.object_id,
            object_name=self.scene.items[state.target].name,
            displacement_m=moved.tolist() if state.mark == "end" else None,
        )

    def _image(self, state: SceneState, renderer: "Renderer") -> Image:
        camera = renderer.camera
        return Image(
            stamp_ns=self.stamp_ns(state.frame),
            sensor=self._sensor,
            format="jpeg",
            width=camera.width,
            height=camera.height,
            data=renderer.jpeg(state),
            K=camera.matrix.ravel().tolist(),
            distortion=[0.0] * 5,
            skeleton_from_image=np.eye(4).ravel().tolist(),
            session_id=self._session_id,
        )


def session_of(start_ns: int) -> str:
    """Return the session of a service that starts at a stamp: the same scene, started anew, is another session."""
    return f"simulator-{start_ns}"


def labelled_stream(simulator: Source) -> Iterator[Message]:
    """Yield a simulated scene's messages with a labelled mark after each truth, as in a training recording."""
    for messages in simulator.frames():
        for message in messages:
            yield message
            if isinstance(message, Truth):
                yield Segment(
                    stamp_ns=message.stamp_ns,
                    sensor=message.sensor,
                    kind=message.kind,
                    segment_id=message.segment_id,
                    agent=message.agent,
                    hand=message.hand,
                    label=message.action,
                    origin=SIMULATOR,
                )
