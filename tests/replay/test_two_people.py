"""Two people before one camera pass each other: each stays one agent, and the event names who acted."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from actum.messages import Agent, Event, Message, Posture, Segment
from actum.node import SECOND_NS, Counters
from camera_bodies import Array, as_seen, landmark_points
from chain import answers, by_key, delayed
from people import reaching
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from sensor_gateway.captured_picture import Picture
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.perceiver import Perceiver

FRAME_NS = SECOND_NS // 20
FRAMES = 80
DARK = np.zeros((480, 640, 3), np.uint8)
HIDDEN_PX = 60.0


def one_at(i: int) -> Array:
    """Walk from left to right, nearer to the camera."""
    return _person(-1.0 + 2.0 * i / FRAMES, 2.2, 0.0)


def other_at(i: int) -> Array:
    """Walk from right to left behind the first, and reach for something afterwards."""
    return _person(0.9 - 1.8 * i / FRAMES, 3.2, float(np.sin(np.pi * max(i - 50, 0) / 30)))


def _person(x_m: float, z_m: float, phase: float) -> Array:
    joints = reaching(phase)
    return landmark_points(joints - joints.mean(axis=0) + [x_m, 0.1, z_m])


class Crossing:
    """A model that finds both in any order, and only the one in front where they overlap."""

    def __init__(self) -> None:
        self._rng = np.random.default_rng(0)

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[Landmarks]:
        i = stamp_ns // FRAME_NS - 1
        front, behind = as_seen(one_at(i)), as_seen(other_at(i))
        if abs(front.image_px[:, 0].mean() - behind.image_px[:, 0].mean()) < HIDDEN_PX:
            return [self._noisy(front)]
        found = [self._noisy(front), self._noisy(behind)]
        return found if self._rng.random() < 0.5 else found[::-1]

    def _noisy(self, marks: Landmarks) -> Landmarks:
        return replace(
            marks,
            image_px=marks.image_px + self._rng.normal(0, 1.5, (33, 2)),
            world_m=marks.world_m + self._rng.normal(0, 0.01, (33, 3)),
        )


@pytest.fixture(scope="module")
def frames() -> list[list[Agent]]:
    perceiver = Perceiver(Crossing(), Optics(), "kinect0", "test", Counters())
    return [perceiver.skeleton(Picture(DARK, (i + 1) * FRAME_NS)).agents for i in range(FRAMES)]


def test_they_are_two_agents_before_and_after_and_the_one_in_front_stays_in_between(frames) -> None:
    numbers = [{agent.agent for agent in agents} for agents in frames]
    assert {frozenset(found) for found in numbers} == {frozenset({1, 2}), frozenset({1})} or {
        frozenset(found) for found in numbers
    } == {frozenset({1, 2}), frozenset({2})}
    assert 5 < sum(len(found) == 1 for found in numbers) < 30


def test_each_number_goes_on_one_way(frames) -> None:
    ways = {number: _torsos_x(frames, number) for number in (1, 2)}
    falling = [number for number, way in ways.items() if way[0] > way[-1]]
    assert len(falling) == 1
    for number, way in ways.items():
        steps = np.diff(way[:: len(way) // 8])
        assert (steps < 0).all() if number in falling else (steps > 0).all()


def _torsos_x(frames: Sequence[list[Agent]], number: int) -> list[float]:
    torsos = [agent.joints[2] for agents in frames for agent in agents if agent.agent == number]
    return [torso[0] for torso in torsos if torso is not None]


@pytest.mark.parametrize("acting", [1, 2])
def test_the_event_names_the_agent_that_was_marked(frames, acting: int) -> None:
    perceiver = Perceiver(Crossing(), Optics(), "kinect0", "test", Counters())
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    messages: list[Message] = []
    for i in range(FRAMES):
        messages += preprocessor.handle(perceiver.skeleton(Picture(DARK, (i + 1) * FRAME_NS)))
    assert all(isinstance(message, Posture) and message.valid for message in messages)
    span = {"start": 55 * FRAME_NS, "end": 78 * FRAME_NS}
    messages += [
        Segment(stamp_ns=stamp_ns, sensor="kinect0", kind=kind, segment_id="s", agent=acting)
        for kind, stamp_ns in span.items()
    ]
    streams = {key: delayed(stream, [0]) for key, stream in by_key(messages).items()}
    [event] = [answer for answer in answers(streams) if isinstance(answer, Event)]
    assert (event.agent, event.segment_id, event.valid, event.frames) == (acting, "s", True, 24)
