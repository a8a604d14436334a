from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations, islice, pairwise

import cv2
import numpy as np
import pytest
from benchmarks.rig.hard_scenes.conditions import Conditions, load_conditions
from benchmarks.rig.hard_scenes.exposure import mean_image, states_while_open
from benchmarks.rig.hard_scenes.hard_renderer import HardRenderer
from benchmarks.rig.hard_scenes.hard_scene import HardScene
from benchmarks.rig.hard_scenes.hard_simulator import HardSimulator
from benchmarks.rig.hard_scenes.pantomime import NO_OBJECT, Pantomime
from pydantic import ValidationError

from actum.messages import Message, Truth
from actum.skeletons import INDEX
from scene_simulator.programme import Task
from scene_simulator.random_streams import random_stream
from scene_simulator.simulated_scene import CLOSED, SceneState
from scene_simulator.simulator import Simulator

pytestmark = pytest.mark.thorough

PROGRAMME = [Task("push", 1), Task("lift", 2), Task("put", 3)]
CONTACT = ("push", "pull", "put", "lift")


def scene(programme: Sequence[Task] = PROGRAMME, **conditions: float) -> HardScene:
    return HardScene(programme, 42, 7, Conditions.model_validate(conditions))


def renderer(of: HardScene) -> HardRenderer:
    return HardRenderer(of, random_stream("test"))


def detected(image: np.ndarray) -> set[int]:
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    ids = detector.detectMarkers(image)[1]
    return set() if ids is None else set(ids.ravel().tolist())


def shares(of: HardScene, states: list[SceneState]) -> Mapping[int, float]:
    """In which share of images each marker is found."""
    drawing = renderer(of)
    found = [detected(drawing.image(state)) for state in states]
    assert set().union(*found) <= {1, 2, 3}
    return {marker: sum(marker in ids for ids in found) / len(found) for marker in (1, 2, 3)}


def free(of: HardScene, every: int = 9) -> list[SceneState]:
    """States in which no hand closes on anything."""
    return [state for state in of.states() if state.grip == 0][::every]


def way_of_the_hand(frames: tuple[SceneState, SceneState]) -> float:
    before, state = frames
    return float(np.linalg.norm(state.fingertip_m - before.fingertip_m))


def truths(messages: list[Message]) -> list[Truth]:
    return [message for message in messages if isinstance(message, Truth)]


def test_no_conditions_change_nothing() -> None:
    plain, named = (Simulator(PROGRAMME, 2, 5), HardSimulator(PROGRAMME, 2, 5, load_conditions()["plain"]))
    assert list(islice(plain.frames(), 60)) == list(islice(named.frames(), 60))


@pytest.mark.parametrize("spacing_m", [0.10, 0.20, 0.30])
def test_objects_stand_in_a_row_as_far_apart_as_asked(spacing_m: float) -> None:
    made = scene(spacing_m=spacing_m)
    for trial in made.trials:
        x, _, z = trial.layout.positions_m.T
        np.testing.assert_allclose(np.diff(np.sort(x)), spacing_m)
        assert np.ptp(z) <= 0.02
    assert all(item.size_m[0] < 0.9 * spacing_m for item in made.items)
    assert min(shares(made, free(made)).values()) > 0.8


def test_objects_shrink_with_their_markers_only_where_there_is_no_room() -> None:
    near, far = scene(spacing_m=0.10).parameters.objects, scene(spacing_m=0.20).parameters.objects
    scale = near.marker_size_m / far.marker_size_m

    assert far.marker_size_m == 0.08
    assert scale == pytest.approx(0.7)
    for small, large in zip(near.items, far.items, strict=True):
        np.testing.assert_allclose(small.size_m, np.multiply(scale, large.size_m))


@pytest.mark.parametrize("distance_m", [1.0, 2.0])
def test_a_person_points_from_as_far_as_asked(distance_m: float) -> None:
    pointing = scene([Task("point", 2)], spacing_m=0.2, distance_m=distance_m)
    state = next(s for s in pointing.states() if s.pointing > 0.99)
    eye, target = state.joints_m[INDEX["head"]], state.positions_m[1]
    ray = state.fingertip_m - eye

    assert pointing.trials[0].layout.pelvis_m[2] - target[2] == pytest.approx(distance_m, abs=0.1)
    assert np.linalg.norm(np.cross(ray / np.linalg.norm(ray), target - eye)) < 0.15 * distance_m
    assert detected(renderer(pointing).image(state)) == {1, 2, 3}


def test_the_hand_hides_the_marker_from_grasp_to_release_and_no_other() -> None:
    made = scene(spacing_m=0.2, covers_marker=True)
    drawing = renderer(made)
    for state in [s for s in made.states() if s.grip > CLOSED][::6]:
        held = made.items[state.target].id
        assert held not in detected(drawing.image(state))
        assert held in detected(drawing.image(replace(state, grip=0.0)))
    assert min(shares(made, free(made)).values()) > 0.95


def test_each_marker_by_itself_is_unread_in_the_share_asked_for() -> None:
    made = scene(spacing_m=0.2, unread_share=0.3)
    states = free(made, every=4)
    first = shares(made, states)

    for share in first.values():
        assert share == pytest.approx(0.7, abs=3 * np.sqrt(0.21 / len(states)))
    assert len(set(first.values())) > 1
    assert shares(made, states) == first
    assert max(shares(scene(unread_share=1.0), states[:5]).values()) == 0


def test_clutter_adds_edges_and_no_markers() -> None:
    plain, busy = scene(spacing_m=0.2), scene(spacing_m=0.2, clutter=60)
    edges = [np.count_nonzero(cv2.Canny(renderer(of).clean_image(free(of)[0]), 50, 150)) for of in (plain, busy)]

    assert edges[1] > 2 * edges[0]
    assert min(shares(busy, free(busy)).values()) > 0.9


def test_defocus_takes_detail_away() -> None:
    sharp, soft = scene(), scene(defocus_sd_px=1.5)
    states = [free(sharp)[0]]
    detail = [cv2.Laplacian(renderer(of).image(states[0]), cv2.CV_64F).var() for of in (sharp, soft)]
    assert detail[1] < 0.7 * detail[0]


def test_an_open_shutter_takes_in_the_way_since_and_smears_only_what_moves() -> None:
    made = scene()
    before, state = max(pairwise(made.states()), key=way_of_the_hand)
    instants = states_while_open(before, state, 0.5)
    drawn = [renderer(made).clean_image(instant) for instant in instants]
    smeared = np.abs(mean_image(drawn).astype(int) - drawn[-1]).max(axis=2) > 20

    np.testing.assert_allclose(instants[0].joints_m, (before.joints_m + state.joints_m) / 2)
    np.testing.assert_allclose(instants[-1].joints_m, state.joints_m)
    assert states_while_open(before, state, 0.0) == [state]
    assert 0.001 < smeared.mean() < 0.05
    np.testing.assert_array_equal(mean_image([drawn[0]] * 3), drawn[0])


@pytest.mark.parametrize("spacing_m", [0.10, 0.20, 0.30])
def test_a_pantomime_is_done_far_from_every_object_and_moves_none(spacing_m: float) -> None:
    programme = [Pantomime(action) for action in CONTACT] * 3
    made = scene(programme, spacing_m=spacing_m)
    hand = INDEX[f"{made.actor.hand}_hand"]
    for state in made.states():
        trial = made.trials[state.segment or 0]
        if state.segment is None:
            continue
        np.testing.assert_array_equal(state.positions_m, trial.layout.positions_m)
        if state.grip > CLOSED:
            assert np.linalg.norm(state.positions_m - state.joints_m[hand], axis=1).min() > 0.35
    assert renderer(made).image(state).shape == (480, 640, 3)


@pytest.mark.parametrize("near_m", [0.12, 0.2])
def test_a_pantomime_comes_as_near_to_an_object_as_asked(near_m: float) -> None:
    made = scene([Pantomime(action) for action in CONTACT], spacing_m=0.2, pantomime_m=near_m)
    hand = INDEX[f"{made.actor.hand}_hand"]
    for number in range(len(CONTACT)):
        held = [state for state in made.states() if state.segment == number and state.grip > CLOSED]
        nearest_m = min(np.linalg.norm(s.positions_m - s.joints_m[hand], axis=1).min() for s in held)
        assert near_m - 0.02 < nearest_m < near_m + 0.1


def test_pantomimes_differ_as_the_actions_do() -> None:
    moved = {action: scene([Pantomime(action)]).trials[0].displacement_m for action in CONTACT}
    assert moved["push"][2] < -0.08
    assert moved["pull"][2] > 0.08
    assert moved["lift"][1] < -0.09
    assert moved["put"][1] > 0.11


def test_the_truth_of_a_pantomime_names_no_object() -> None:
    simulator = HardSimulator([Pantomime("push")], 0, 0, load_conditions()["plain"], image_hz=0)
    start, end = truths([message for messages in simulator.frames() for message in messages])

    assert (start.action, end.action) == ("push", "push")
    assert (end.object_id, end.object_name, end.displacement_m) == (NO_OBJECT, "", None)


def test_pointing_has_no_pantomime() -> None:
    with pytest.raises(ValueError, match="has no pantomime"):
        Pantomime("point")


def test_a_pantomime_without_room_is_refused() -> None:
    with pytest.raises(ValueError, match="no empty space"):
        scene([Pantomime("push")], pantomime_m=3.0)


def test_the_named_conditions_are_all_different() -> None:
    named = load_conditions()
    assert set(named) == {"plain", "cluttered", "blurred", "unread", "covered", "together"}
    assert all(one != other for one, other in combinations(named.values(), 2))


@pytest.mark.parametrize("wrong", [{"spacing_m": 0}, {"unread_share": 1.1}, {"clutter": -1}, {"fog": 1}])
def test_conditions_that_cannot_be_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        Conditions.model_validate(wrong)
