"""What the gateway makes of people before a colour and before a depth camera, and how joints are drawn."""

from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from actum.messages import Agent
from actum.node import SECOND_NS, Counters
from actum_command.skeleton_overlay import drawn, sheet
from approving import Approve
from calls import calls_of
from rendered_bodies import Person, depth_of, landmarks_of, person
from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.lens import Lens
from sensor_gateway.optics import DepthOptics, Optics
from sensor_gateway.people.identities import Identities
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.perceiver import Perceiver

WIDTH, HEIGHT = 320, 240
LENS = Lens.of_field_of_view(WIDTH, HEIGHT, 60.0)
FRAME_NS = SECOND_NS // 10
SEEDS = (1, 5)
"""Crowds whose numbers depend on every constant of the tracking."""


class Scripted:
    """A pose model that finds given people, of whom one is lost for a while."""

    def __init__(self, found: list[list[Landmarks]]) -> None:
        self._found = iter(found)

    def people(self, image_bgr: NDArray[np.uint8], stamp_ns: int) -> list[Landmarks]:
        return next(self._found)


def passing() -> Iterator[list[Person]]:
    """Two people of different size walk past each other, turning; one is not found for a second."""
    for i in range(40):
        raised = (-0.3 + 0.01 * i, -0.4 - 0.01 * i, -0.2)
        one = person((-0.9 + 0.045 * i, 0.1, 2.2), turn_deg=20 - i, size=1.1, right_wrist=raised)
        other = person((0.9 - 0.045 * i, 0.0, 3.2), turn_deg=i, size=0.85, left_elbow=(0.4, -0.45, -0.1))
        yield [one, other] if not 15 <= i < 25 else [one]


def seen(people: list[Person], i: int) -> list[Landmarks]:
    rng = np.random.default_rng(i)
    hidden = ("left_wrist", "left_index", "left_pinky") if i % 3 == 0 else ()
    return [
        landmarks_of(body, LENS, wrong_m=rng.normal(0, 0.02, 33), hidden=hidden, off_px=rng.normal(0, 0.7, (33, 2)))
        for body in people[:: 1 if i % 2 else -1]
    ]


def test_people_before_a_colour_camera_are_placed_as_approved(approve: Approve) -> None:
    found = [seen(people, i) for i, people in enumerate(passing())]
    blank = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    given = {}
    for name, optics in {"unknown height": Optics(), "known height": Optics(62.0, None, 1.8, mirrored=True)}.items():
        perceiver = Perceiver(Scripted(found), optics, "kinect0", "session", Counters())
        given[name] = [perceiver.skeleton(Picture(blank, (i + 1) * FRAME_NS)) for i in range(len(found))]
    approve("colour-camera", given, 1e-6)


def test_people_before_a_depth_camera_are_placed_as_approved(approve: Approve) -> None:
    people = list(passing())[::4]
    found = [seen(each, i)[:1] for i, each in enumerate(people)]
    perceiver = Perceiver(Scripted(found), DepthOptics(), "kinect0", "session", Counters())
    blank = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    skeletons = [
        perceiver.skeleton(DepthPicture(blank, (i + 1) * FRAME_NS, measured(bodies, i), LENS))
        for i, bodies in enumerate(people)
    ]
    approve("depth-camera", skeletons, 1e-5)


def crowd(seed: int) -> Iterator[dict[int, NDArray[np.float64]]]:
    """Yield who is found where, in any order: four people cross one another's ways and are lost for 0.7 s or longer."""
    rng, people, frames, lost_for = np.random.default_rng(seed), 4, 220, 11
    starts, speeds = rng.uniform(0, 2 * np.pi, (2, people, 1, 3)), rng.uniform(0.2, 1.4, (2, people, 1, 3))
    x, z = np.sin(np.arange(frames)[:, None] / 15 * speeds + starts).sum(axis=3)
    places = np.stack([0.5 * x, 0 * x, 3 + 0.35 * z], axis=2) + rng.normal(0, 0.03, (people, frames, 3))
    places *= rng.normal(1, 0.06, (people, frames, 1))
    lost = np.repeat(rng.random((people, frames // lost_for)) < 0.35, lost_for, axis=1)
    for i in range(frames):
        yield {int(one): places[one, i] for one in rng.permutation(people) if not lost[one, i]}


def numbers_in(seed: int) -> list[dict[str, int]]:
    people, numbers = Identities(), []
    for i, found in enumerate(crowd(seed)):
        of = dict(zip(found, people.step(i * SECOND_NS // 15, list(found.values())), strict=True))
        numbers.append({f"person {one}": of.get(one, 0) for one in range(4)})
    return numbers


def test_the_people_of_a_crowd_are_numbered_as_approved(approve: Approve) -> None:
    approve("crowds", {f"crowd {seed}": numbers_in(seed) for seed in SEEDS})


def measured(bodies: list[Person], seed: int) -> NDArray[np.float32]:
    """Render depth with noise, holes, and something narrow in front of the people."""
    rng = np.random.default_rng(seed)
    depth = np.minimum.reduce([depth_of(body, LENS, WIDTH, HEIGHT) for body in bodies])
    depth += rng.normal(0, 0.004, depth.shape).astype(np.float32)
    depth[:, 100:104] = 1.2
    depth[rng.random(depth.shape) < 0.2] = 0
    return depth


def test_joints_are_drawn_into_a_picture_as_approved(approve: Approve, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = calls_of(monkeypatch, cv2, "line", "circle", "putText")
    bodies = [person((0.3, 0.0, 2.5)), person((-0.4, 0.1, 3.0), turn_deg=30)]
    agents = [
        Agent(agent=n, joints=[None, *body.joints_m[1:].tolist()], confidence=[0.5] * 15)
        for n, body in enumerate(bodies, start=1)
    ]
    picture = drawn(np.full((HEIGHT, WIDTH, 3), 90, np.uint8), agents, LENS, "3 s")
    approve("overlay", {"calls": calls, "sheet": sheet([picture, picture // 2, picture // 3], 2)}, 1e-5)
