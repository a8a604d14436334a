from itertools import pairwise

import numpy as np
import pytest

from actum.arrays import Array
from actum.skeletons import INDEX
from scene_simulator.programme import ACTIONS, Task, balanced_programme
from scene_simulator.simulated_scene import CLOSED, Scene, SceneState
from scene_simulator.trial import Trial

RATE_HZ = 30
SEEDS = range(4)


@pytest.fixture(scope="module", params=SEEDS)
def scene(request: pytest.FixtureRequest) -> Scene:
    return Scene(balanced_programme(3, request.param), request.param, request.param + 100)


@pytest.fixture(scope="module")
def states(scene: Scene) -> list[SceneState]:
    return list(scene.states())


@pytest.fixture(scope="module")
def segments(scene: Scene, states: list[SceneState]) -> list[tuple[Trial, list[SceneState]]]:
    return [(trial, [s for s in states if s.segment == number]) for number, trial in enumerate(scene.trials)]


def hand_of(scene: Scene, state: SceneState) -> Array:
    return state.joints_m[INDEX[f"{scene.actor.hand}_hand"]]


def forward(trial: Trial) -> Array:
    heading = trial.layout.heading_rad
    return np.array([-np.sin(heading), 0.0, -np.cos(heading)])


def test_an_action_lasts_between_one_and_a_half_and_two_and_a_half_seconds(segments) -> None:
    for _, frames in segments:
        assert 1.5 * RATE_HZ <= len(frames) - 1 <= 2.5 * RATE_HZ
        assert [f.mark for f in frames] == ["start", *[None] * (len(frames) - 2), "end"]


def test_frames_are_numbered_without_a_gap_and_actions_are_apart(scene: Scene, states: list[SceneState]) -> None:
    assert [s.frame for s in states] == list(range(len(states)))
    pauses = np.diff([s.frame for s in states if s.segment is not None])
    assert pauses[pauses > 1].min() >= 1.0 * RATE_HZ
    assert len(states) - 1 - max(s.frame for s in states if s.segment is not None) == 3 * RATE_HZ


def test_each_action_has_its_own_effect_on_its_object_and_none_on_the_others(segments) -> None:
    for trial, frames in segments:
        moved = frames[-1].positions_m - frames[0].positions_m
        own = moved[trial.target]
        np.testing.assert_allclose(np.delete(moved, trial.target, axis=0), 0, atol=1e-12)
        np.testing.assert_allclose(own, trial.displacement_m, atol=2e-3)
        away, up = own @ forward(trial), -own[1]
        effect = {
            "push": 0.09 < away < 0.23 and abs(up) < 1e-9,
            "pull": -0.23 < away < -0.09 and abs(up) < 1e-9,
            "lift": 0.09 < up < 0.23,
            "put": -0.21 < up < -0.11,
            "point": np.allclose(own, 0),
        }
        assert effect[trial.task.action]


def test_the_hand_takes_the_object_along(scene: Scene, segments) -> None:
    for trial, frames in segments:
        offsets = [hand_of(scene, f) - f.positions_m[trial.target] for f in frames if f.grip > CLOSED]
        moving = offsets[len(offsets) // 4 :]
        if trial.task.action != "point":
            np.testing.assert_allclose(moving, np.broadcast_to(moving[-1], (len(moving), 3)), atol=2e-3)


def test_the_hand_comes_closest_to_the_object_it_acts_on(scene: Scene, segments) -> None:
    for trial, frames in segments:
        if trial.task.action == "point":
            continue
        distances = [np.linalg.norm(f.positions_m - hand_of(scene, f), axis=1) for f in frames]
        assert np.argmin(np.min(distances, axis=0)) == trial.target
        assert np.min(distances) < 0.16


def test_a_pointing_hand_stays_clear_of_its_object(scene: Scene) -> None:
    pointing = Scene([Task("point", i) for i in (1, 2, 3)] * 2, 3, 8)
    for state in pointing.states():
        if state.segment is not None:
            assert np.linalg.norm(hand_of(pointing, state) - state.positions_m[state.target]) > 0.15


def test_only_what_is_put_down_always_starts_raised(segments) -> None:
    for trial, frames in segments:
        raised = trial.layout.riser_heights_m[trial.target]
        assert (raised > 0) or trial.task.action != "put"
        assert (raised == 0) or trial.task.action in ("put", "lift", "point")
        bottom = frames[0].riser_tops_m[trial.target, 1]
        assert bottom == pytest.approx(0.42 - raised)


def test_nothing_jumps(scene: Scene, states: list[SceneState]) -> None:
    for before, after in pairwise(states):
        assert np.abs(after.joints_m - before.joints_m).max() * RATE_HZ < 3.0
        assert np.abs(after.positions_m - before.positions_m).max() * RATE_HZ < 3.0


def test_objects_stand_on_their_support_and_the_hand_stays_above_the_table(scene: Scene, segments) -> None:
    table_y = scene.parameters.table_y_m
    heights = np.array([item.size_m[1] for item in scene.items])
    for _, frames in segments:
        for state in frames:
            assert np.all(state.positions_m[:, 1] + heights / 2 < table_y + 1e-9)
            assert hand_of(scene, state)[1] < table_y
        np.testing.assert_allclose(frames[0].positions_m[:, 1] + heights / 2, frames[0].riser_tops_m[:, 1])


def test_the_arm_reaches_everything_without_being_drawn_back(scene: Scene, states: list[SceneState]) -> None:
    side = scene.actor.hand
    for state in states:
        reach = np.linalg.norm(state.joints_m[INDEX[f"{side}_hand"]] - state.joints_m[INDEX[f"{side}_shoulder"]])
        assert reach < 0.95 * scene.actor.arm_m


def test_an_objects_pose_looks_at_the_camera(states: list[SceneState]) -> None:
    pose = states[0].camera_from_object(1)

    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    assert pose[2, 2] < -0.9
    assert pose[1, 1] == -1
    np.testing.assert_array_equal(pose[:3, 3], states[0].positions_m[1])


def test_the_same_seeds_give_the_same_scene_and_others_another() -> None:
    programme = [Task(action, 1) for action in ACTIONS]

    def path(actor_seed: int, seed: int) -> Array:
        return np.array([s.joints_m for s in Scene(programme, actor_seed, seed).states()][:100])

    np.testing.assert_array_equal(path(1, 2), path(1, 2))
    assert np.abs(path(1, 2) - path(1, 3)).max() > 0.01
    assert np.abs(path(1, 2) - path(2, 2)).max() > 0.01


def test_an_empty_programme_is_refused() -> None:
    with pytest.raises(ValueError, match="person has nothing to do"):
        Scene([], 0, 0)


def test_an_object_that_keeps_its_place_does_not_move_while_the_hand_returns() -> None:
    states = list(Scene([Task("lift", 1)], 0, 0).states())
    ended = next(i for i, state in enumerate(states) if state.mark == "end")
    moved = [np.ptp([state.positions_m[row] for state in states[ended:]], axis=0).max() for row in range(3)]
    assert [way_m > 1e-9 for way_m in moved] == [True, False, False]
