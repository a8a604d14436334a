"""What people do besides the actions: without marks, at human speeds, and never touching an object."""

from itertools import groupby, pairwise

import numpy as np
import pytest

from actum.messages import Message, Segment, Skeleton, Truth
from actum.skeletons import INDEX
from scene_simulator.actor import HEAD
from scene_simulator.everyday import ALL, FAMILIAR, KEPT_ASIDE, Everyday, chosen
from scene_simulator.programme import balanced_programme
from scene_simulator.simulated_scene import Scene, SceneState
from scene_simulator.simulator import Simulator, labelled_stream

RATE_HZ = 30
HANDS = [INDEX["left_hand"], INDEX["right_hand"]]
FASTEST_M_S = {"hand": 3.0, "elbow": 3.5, "knee": 3.0, "foot": 5.0}
"""As in unhurried movements; in walking a knee swings at twice the speed of the pelvis, a foot at three times."""
FASTEST_TRUNK_M_S = 2.0


SEEDS = (61, 62, 61)
"""Of scenes of the actors 0, 1 and 2 that together show each kind of doing in each of its variations."""


@pytest.fixture(scope="module", params=range(3))
def idle(request: pytest.FixtureRequest) -> Scene:
    return Scene([], request.param, SEEDS[request.param], everyday=Everyday(least_s=300))


@pytest.fixture(scope="module")
def states(idle: Scene) -> list[SceneState]:
    return list(idle.states())


def test_the_doings_are_those_beside_which_the_shipped_model_was_trained(
    states: list[SceneState], request: pytest.FixtureRequest
) -> None:
    """Where this fails on purpose, `make simulated-model` trains the model anew."""
    expected = (-0.2945127704, 0.2866991967, -0.6599391166)[request.node.callspec.params["idle"]]
    assert number_of(states) == pytest.approx(expected, abs=1e-6)


@pytest.fixture(scope="module")
def busy() -> list[SceneState]:
    return list(Scene(balanced_programme(3, 4), 1, 4, everyday=Everyday()).states())


def test_so_are_the_actions(busy: list[SceneState]) -> None:
    assert number_of(busy) == pytest.approx(-0.0015993747, abs=1e-6)


def number_of(states: list[SceneState]) -> float:
    """Return a number that each coordinate of people and objects changes."""
    numbers = np.concatenate([[*state.joints_m.ravel(), *state.positions_m.ravel()] for state in states])
    return float(numbers @ np.cos(np.arange(len(numbers))))


def all_of(simulator: Simulator) -> list[Message]:
    return [message for messages in simulator.frames() for message in messages]


def joints(states: list[SceneState], *names: str) -> np.ndarray:
    return np.array([state.joints_m[[INDEX[name] for name in names]] for state in states])


def distances_to_objects(scene: Scene, states: list[SceneState]) -> np.ndarray:
    """Return the distance of each hand from the nearest object's middle (T, 2; m)."""
    half_depths = np.array([[0, 0, item.size_m[2] / 2] for item in scene.items])
    middles = np.array([state.positions_m for state in states]) + half_depths
    hands = np.array([state.joints_m[HANDS] for state in states])
    return np.linalg.norm(hands[:, :, None] - middles[:, None], axis=-1).min(axis=-1)


def test_the_same_arguments_give_the_same_messages_and_another_seed_other_ones() -> None:
    def messages(seed: int) -> list[Message]:
        return all_of(Simulator(balanced_programme(1, 1), 2, seed, image_hz=0, everyday=Everyday()))

    assert messages(5) == messages(5)
    assert messages(5) != messages(6)


def test_actions_are_the_same_with_and_without_doings_between_them() -> None:
    programme = balanced_programme(1, 1)
    plain, lively = Scene(programme, 2, 5), Scene(programme, 2, 5, everyday=Everyday())

    for one, other in zip(plain.trials, lively.trials, strict=True):
        assert one.task == other.task
        np.testing.assert_array_equal(one.hand_m, other.hand_m)


def test_doings_have_no_truth_and_no_mark() -> None:
    simulator = Simulator(balanced_programme(2, 1), 2, 5, image_hz=0, everyday=Everyday(least_s=200))
    doing_ns = {simulator.stamp_ns(state.frame) for state in simulator.scene.states() if state.doing is not None}
    messages = list(labelled_stream(simulator))
    marks = [message for message in messages if isinstance(message, Truth | Segment)]

    assert len(marks) == 4 * 10
    assert len(doing_ns) > 100 * RATE_HZ
    for start, end in zip(marks[::4], marks[2::4], strict=True):
        assert (start.kind, end.kind) == ("start", "end")
        assert not any(start.stamp_ns <= stamp_ns <= end.stamp_ns for stamp_ns in doing_ns)


def test_actions_do_not_overlap_and_some_follow_each_other_at_once(busy: list[SceneState]) -> None:
    marks = [(state.frame, state.mark) for state in busy if state.mark is not None]

    assert [mark for _, mark in marks] == ["start", "end"] * 15
    gaps_s = np.array([after[0] - before[0] for before, after in list(pairwise(marks))[1::2]]) / RATE_HZ
    assert gaps_s.min() < 1.4
    assert np.median(gaps_s) > 5


def test_a_scene_without_actions_lasts_as_long_as_it_has_to_and_has_no_truth() -> None:
    simulator = Simulator([], 3, 1, image_hz=0, everyday=Everyday(least_s=200), start_ns=10**15)
    messages = all_of(simulator)

    assert all(isinstance(message, Skeleton) for message in messages)
    assert 200 * 10**9 <= messages[-1].stamp_ns - 10**15 < 300 * 10**9


def test_every_kind_of_doing_occurs() -> None:
    scenes = [Scene([], actor, 0, everyday=Everyday(least_s=600)) for actor in range(3)]
    assert {state.doing for scene in scenes for state in scene.states()} == {None, *ALL}


def test_short_pauses_have_one_doing_at_most_and_make_a_scene_half_as_long(busy: list[SceneState]) -> None:
    programme = balanced_programme(3, 4)
    states = list(Scene(programme, 1, 4, everyday=Everyday(pauses="short")).states())
    pauses = [list(pause) for acts, pause in groupby(states, key=lambda s: s.segment is not None) if not acts]

    assert len(states) < 0.6 * len(busy)
    assert max(len(set(doings(pause))) for pause in pauses) == 1
    assert any(not doings(pause) for pause in pauses)


def doings(states: list[SceneState]) -> list[str]:
    return [state.doing for state in states if state.doing is not None]


def test_kinds_that_are_kept_aside_for_tests_do_not_occur_in_training() -> None:
    assert set(FAMILIAR) | set(KEPT_ASIDE) == set(ALL)
    for actor in range(3):
        scene = Scene([], actor, 0, everyday=chosen("familiar", minutes=10))
        assert {state.doing for state in scene.states()} <= {None, *FAMILIAR}


def test_some_kinds_of_doings_are_commoner_with_one_person_than_with_another() -> None:
    def share(actor: int, kind: str) -> float:
        states = list(Scene([], actor, 0, everyday=Everyday(("gesture", kind), least_s=300)).states())
        return sum(state.doing == kind for state in states) / len(states)

    shares = [share(actor, "scratch_head") for actor in range(4)]
    assert max(shares) > 1.3 * min(shares)


def test_movements_have_human_speeds(states: list[SceneState]) -> None:
    for name, row in INDEX.items():
        speeds = np.linalg.norm(np.diff([state.joints_m[row] for state in states], axis=0), axis=1) * RATE_HZ
        assert speeds.max() < FASTEST_M_S.get(name.rsplit("_", 1)[-1], FASTEST_TRUNK_M_S), name


def test_hands_are_as_fast_as_in_actions(states: list[SceneState], busy: list[SceneState]) -> None:
    def fast(some: list[SceneState]) -> float:
        speeds = np.linalg.norm(np.diff(joints(some, "left_hand", "right_hand"), axis=0), axis=-1).max(axis=1) * RATE_HZ
        return float(np.percentile(speeds, 90))

    doing = [state for state in states if state.doing not in (None, "walk_away", "pace")]
    acting = [state for state in busy if state.segment is not None]
    assert 0.5 < fast(doing) / fast(acting) < 2.0


def test_hands_also_move_before_the_body_at_the_height_of_the_table(idle: Scene, states: list[SceneState]) -> None:
    hands = joints([state for state in states if state.doing is not None], "left_hand", "right_hand")
    over_table = hands[..., 2] < idle.parameters.table.far_z_m
    low = np.abs(hands[..., 1] - idle.parameters.table_y_m + 0.1) < 0.1

    assert (over_table & low).any(axis=1).mean() > 0.1


@pytest.mark.parametrize("side", ["left", "right"])
def test_bones_of_arms_and_legs_keep_their_lengths(side: str, states: list[SceneState]) -> None:
    for parts in (("shoulder", "elbow"), ("elbow", "hand"), ("hip", "knee"), ("knee", "foot")):
        ends = joints(states, *(f"{side}_{part}" for part in parts))
        lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        np.testing.assert_allclose(lengths, lengths[0], atol=1e-6)


def test_the_neck_carries_the_head_at_its_distance(idle: Scene, states: list[SceneState]) -> None:
    ends = joints(states, "neck", "head")
    np.testing.assert_allclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), HEAD * idle.actor.height_m, atol=1e-9)


def test_while_a_person_is_away_skeletons_have_no_agent_and_then_the_same_one() -> None:
    simulator = Simulator([], 1, 2, image_hz=0, everyday=Everyday(("walk_away",), least_s=60))
    numbers = [[agent.agent for agent in m.agents] for m in all_of(simulator) if isinstance(m, Skeleton)]
    changes = [after for before, after in pairwise(numbers) if before != after]

    assert numbers[0] == numbers[-1] == [1]
    assert changes[:4] == [[], [1], [], [1]]
    assert 2 * RATE_HZ < numbers.index([1], numbers.index([])) - numbers.index([]) < 20 * RATE_HZ


@pytest.mark.parametrize("seed", range(4))
def test_half_actions_come_near_an_object_but_never_touch_it(seed: int) -> None:
    scene = Scene([], seed, seed, everyday=Everyday(("half_reach", "half_lift"), least_s=300))
    states = list(scene.states())
    nearest_m = distances_to_objects(scene, states)

    assert nearest_m.min() > 0.15
    assert nearest_m.min() < 0.22
    moved = np.array([state.positions_m for state in states])
    np.testing.assert_array_equal(moved, np.broadcast_to(moved[0], moved.shape))


def test_no_doing_touches_an_object(idle: Scene, states: list[SceneState]) -> None:
    assert distances_to_objects(idle, states).min() > 0.13


@pytest.mark.parametrize("kinds", [("juggle",), ()])
def test_unknown_doings_and_none_at_all_are_refused(kinds: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match="is not an everyday activity"):
        Everyday(kinds)
