"""People who move freely: the same each time, at human speeds, with bones that keep their lengths."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from benchmarks.free_people.body import RATE_HZ, FreeBody, FreePose
from benchmarks.free_people.movement import _joints, _moved, free_movement
from benchmarks.free_people.phrases import PHRASES

from actum.skeletons import INDEX
from actum.standard_body import BONES
from scene_simulator.actor import draw_actor
from scene_simulator.parameters import load_parameters

FASTEST_M_S = {"hand": 7.0, "foot": 15.0, "head": 4.0}
"""Of a hand in a throw and of a foot in a hard kick. An elbow may turn over in one frame where the arm is stretched."""


def body(person: int = 5) -> FreeBody:
    return FreeBody(draw_actor(load_parameters().actor, person), np.random.default_rng(person))


def joints_m(moved: FreeBody) -> np.ndarray:
    values = np.concatenate(moved.frames)
    return np.asarray(_joints(moved.actor, values, np.zeros((len(values), 3))))


def test_a_person_always_moves_alike_and_another_one_otherwise() -> None:
    one, same, other = (list(free_movement(person, 4.0, "kinect0")) for person in (3, 3, 4))
    assert one == same != other
    assert [skeleton.stamp_ns for skeleton in one] == [n * 10**9 // RATE_HZ for n in range(120)]


@pytest.mark.parametrize("phrase", PHRASES, ids=lambda phrase: phrase.__name__)
def test_every_phrase_moves_the_body_as_bodies_move(phrase: Callable[[FreeBody], None]) -> None:
    moved = body()
    for _ in range(5):
        phrase(moved)
    joints = joints_m(moved)
    assert np.isfinite(joints).all()
    assert np.ptp(joints - joints[:, [INDEX["torso"]]], axis=0).max() > 0.02
    speeds_m_s = RATE_HZ * np.linalg.norm(np.diff(joints, axis=0), axis=2).max(axis=0)
    for name, joint in INDEX.items():
        assert speeds_m_s[joint] < FASTEST_M_S.get(name.split("_")[-1], np.inf)
    ends = (INDEX["left_hand"], INDEX["right_foot"])
    for parent, child in [(parent, child) for parent, child, _ in BONES if child in ends]:
        assert np.ptp(np.linalg.norm(joints[:, parent] - joints[:, child], axis=1)) < 0.03


def test_movements_go_on_where_the_one_before_ended() -> None:
    values = _moved(body(), 60.0)
    assert len(values) == 60 * RATE_HZ
    assert np.abs(np.diff(values, axis=0)).max() < 0.5


def test_an_ellipse_begins_and_ends_where_the_body_is() -> None:
    moved = body()
    start = moved.pose.values()
    moved.repeat(FreePose(np.full((2, 3), 0.1)), np.full(13, 0.05), 1.0, 3.0)
    (frames,) = moved.frames
    assert np.abs(frames[-1] - start).max() < 1e-9
    assert np.abs(frames - start).max() > 0.1


def test_hands_go_where_arms_reach() -> None:
    moved = body()
    for hand in (0, 1):
        places = np.array([moved.anywhere(hand) for _ in range(200)])
        assert np.linalg.norm(places - places.mean(axis=0), axis=1).max() < 2 * moved.actor.arm_m
        assert (places[:, 2] > -0.16).all()


def test_people_differ_in_what_they_like_to_do() -> None:
    ways = [np.ptp(_moved(body(person), 60.0)[:, 9:], axis=0) for person in range(4)]
    assert any(np.abs(one - other).max() > 0.1 for one, other in pairwise(ways))
