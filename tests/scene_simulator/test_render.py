from dataclasses import replace

import cv2
import numpy as np
import pytest

from actum.arrays import Array
from scene_simulator.parameters import load_parameters
from scene_simulator.programme import Task
from scene_simulator.props import RISER_COLOUR
from scene_simulator.random_streams import random_stream
from scene_simulator.render import Renderer
from scene_simulator.simulated_scene import Scene, SceneState

HALF_M = 0.04
CORNERS_M = np.array([[-HALF_M, HALF_M, 0], [HALF_M, HALF_M, 0], [HALF_M, -HALF_M, 0], [-HALF_M, -HALF_M, 0]])


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene([Task("push", 1), Task("lift", 2), Task("put", 3), Task("point", 1)], 4, 9)


@pytest.fixture(scope="module")
def free(scene: Scene) -> list[SceneState]:
    """States in which no hand closes on anything."""
    return [state for state in scene.states() if state.grip == 0][::12]


@pytest.fixture
def renderer(scene: Scene) -> Renderer:
    return Renderer(scene, random_stream("test"))


def detect(image: np.ndarray) -> dict[int, Array]:
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(image)
    return {} if ids is None else {int(i): c[0].astype(float) for i, c in zip(ids.ravel(), corners, strict=True)}


def true_corners(renderer: Renderer, state: SceneState, row: int) -> Array:
    pose = state.camera_from_object(row)
    return renderer.camera.project(CORNERS_M @ pose[:3, :3].T + pose[:3, 3])


def test_the_pictures_are_those_on_which_the_benchmarks_were_measured(
    scene: Scene, renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where this fails on purpose, `make bench-objects bench-tracker` measure anew."""
    numbers: list[float] = []

    def recorded(name: str) -> None:
        draw = getattr(cv2, name)

        def drawing(*arguments: object) -> object:
            for each in arguments[1:]:
                values = np.asarray(each, dtype=float)
                numbers.extend((values.mean(), np.sqrt((values**2).mean())))
            return draw(*arguments)

        monkeypatch.setattr(cv2, name, drawing)

    for name in ("fillConvexPoly", "fillPoly", "polylines", "rectangle", "line", "circle"):
        recorded(name)
    Renderer(scene, random_stream("test"))
    states = list(scene.states())[::30]
    raised_m = np.outer([0.0, 0.1, 0.5], [0.0, -1.0, 0.0])
    for state in [*states, replace(states[0], positions_m=states[0].positions_m + raised_m)]:
        renderer.clean_image(state)
    weights = np.random.default_rng(0).uniform(size=len(numbers))
    assert np.array(numbers) @ weights == pytest.approx(9847573.099, abs=1.0)


def test_uncovered_markers_are_found_where_they_are(scene: Scene, renderer: Renderer, free: list[SceneState]) -> None:
    found = 0
    for state in free:
        markers = detect(renderer.image(state))
        assert set(markers) <= {1, 2, 3}
        for row, item in enumerate(scene.items):
            if item.id in markers:
                found += 1
                np.testing.assert_allclose(markers[item.id], true_corners(renderer, state, row), atol=1.5)
    assert found >= 0.95 * 3 * len(free)


def test_a_sharper_camera_sees_the_markers_exactly_where_they_are() -> None:
    plain = load_parameters()
    sharp = plain.camera.model_copy(update={"width": 2560, "height": 1920, "focal_px": 2100.0})
    scene = Scene([Task("push", 1)], 4, 9, plain.model_copy(update={"camera": sharp}))
    renderer, state = Renderer(scene, random_stream("test")), next(scene.states())
    markers = detect(renderer.image(state))

    for row, item in enumerate(scene.items):
        corners, truth = markers[item.id], true_corners(renderer, state, row)
        np.testing.assert_allclose(corners.mean(axis=0), truth.mean(axis=0), atol=0.1)
        np.testing.assert_allclose(corners, truth, atol=0.5)


def test_marker_poses_are_right_to_a_few_centimetres(scene: Scene, renderer: Renderer, free: list[SceneState]) -> None:
    for state in free[::4]:
        for marker, corners in detect(renderer.image(state)).items():
            row = [item.id for item in scene.items].index(marker)
            _, _, position = cv2.solvePnP(
                CORNERS_M, corners, renderer.camera.matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
            )
            missed = np.abs(position.ravel() - state.positions_m[row])
            assert missed[:2].max() < 0.03
            assert missed[2] < 0.15


def test_fingers_over_the_face_hide_the_marker(scene: Scene, renderer: Renderer) -> None:
    state = next(s for s in scene.states() if s.grip == 1)
    shown, hidden = (replace(state, finger_overlap_m=overlap) for overlap in (-0.015, 0.045))
    target = scene.items[state.target].id

    assert target in detect(renderer.image(shown))
    assert target not in detect(renderer.image(hidden))


def test_what_is_nearer_covers_what_is_farther(scene: Scene, renderer: Renderer, free: list[SceneState]) -> None:
    state = free[0]
    before = state.positions_m.copy()
    before[0] = state.positions_m[1] * 0.9 + np.array([0.0, 0.01, 0.0])
    covering = replace(state, positions_m=before)

    assert set(detect(renderer.image(covering))) == {1, 3}


def test_the_person_is_drawn_where_the_joints_are(scene: Scene, renderer: Renderer, free: list[SceneState]) -> None:
    state = free[0]
    moved = replace(state, joints_m=state.joints_m + np.array([0.5, 0.0, 0.0]))
    changed = np.abs(renderer.clean_image(state).astype(int) - renderer.clean_image(moved)).sum(axis=2) > 0

    for joints in (state.joints_m, moved.joints_m):
        u, v = np.round(renderer.camera.project(joints[0])).astype(int)
        assert changed[v, u]


def test_the_grain_changes_from_image_to_image_and_the_scene_does_not(
    renderer: Renderer, free: list[SceneState]
) -> None:
    first, second = renderer.image(free[0]), renderer.image(free[0])

    assert first.shape == (480, 640, 3)
    assert np.any(first != second)
    np.testing.assert_array_equal(renderer.clean_image(free[0]), renderer.clean_image(free[0]))


def test_a_riser_is_drawn_as_high_as_its_top_and_none_where_that_is_the_table(
    scene: Scene, free: list[SceneState]
) -> None:
    def drawn(height_m: float) -> int:
        """Count the pixels of risers under objects that stand on them."""
        tops_m, positions_m = free[0].riser_tops_m.copy(), free[0].positions_m.copy()
        positions_m[:, 1] += scene.parameters.table_y_m - height_m - tops_m[:, 1]
        tops_m[:, 1] = scene.parameters.table_y_m - height_m
        raised = replace(free[0], riser_tops_m=tops_m, positions_m=positions_m)
        image = Renderer(scene, random_stream("test")).clean_image(raised)
        return int((image == RISER_COLOUR).all(axis=-1).sum())

    assert 10 * drawn(0.0) < drawn(0.05) < drawn(0.1)
