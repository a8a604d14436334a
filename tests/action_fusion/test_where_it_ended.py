"""An event says where the object is at the action's end, in the camera's frame and a fixed one, and if in the hand."""

from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from action_fusion.settings import Settings
from actum import geometry
from actum.command_line import from_command_line
from actum.messages import ActedObject
from fused import event_of
from rotation_of import rotation_of
from scenes import REST_RIGHT, Place, Scene, acting_on, action, at, moving, still

CUP: Place = (0.1, 0.0, 0.45)
LIFTED: Place = (0.1, 0.2, 0.45)
ABOVE_CUP: Place = (0.1, 0.06, 0.45)
PUSHED: Place = (0.1, 0.0, 0.66)
TURNED = [0.0, 0.6, 0.0, 0.8]


def object_of(scene: Scene, label: str = "act", quaternion: list[float] = TURNED, **chosen: object) -> ActedObject:
    sightings = [
        m.model_copy(update={"objects": [o.model_copy(update={"quaternion_xyzw": quaternion}) for o in m.objects]})
        for m in scene.sightings()
    ]
    event = event_of(*scene.postures(), *sightings, action(label), **chosen)
    assert event.object is not None
    return event.object


LIFTING = acting_on(CUP, LIFTED)
LEFT_THERE = replace(
    acting_on(CUP, PUSHED),
    right_hand=moving((0.2, REST_RIGHT), (0.6, (0.1, 0.08, 0.45)), (1.2, (0.1, 0.08, 0.66)), (1.8, (0.1, 0.3, 0.2))),
    objects={1: moving((0.6, CUP), (1.2, PUSHED))},
)
TOUCHING = acting_on(CUP, CUP)


@pytest.mark.parametrize(
    ("scene", "ends"), [(LIFTING, LIFTED), (LEFT_THERE, PUSHED), (TOUCHING, CUP)], ids=["lift", "push", "touch"]
)
def test_the_pose_is_that_of_the_cameras_frame_at_the_end(scene: Scene, ends: Place) -> None:
    found = object_of(scene)
    assert found.pose is not None
    assert found.pose.frame == "camera"
    assert np.allclose(found.pose.position_m, scene.stance.camera(ends), atol=1e-6)
    assert np.allclose(found.pose.quaternion_xyzw or [], TURNED)
    assert found.fixed_pose is None


@pytest.mark.parametrize("hidden", [False, True], ids=["seen", "covered"])
def test_a_lifted_cup_was_taken_along_and_is_in_the_hand(hidden: bool) -> None:
    found = object_of(replace(LIFTING, hidden=lambda number, t: hidden and t > 0.75), "lift")
    assert (found.taken_along, found.in_hand_at_end, found.carried) == (True, True, hidden)


@pytest.mark.parametrize("hidden", [False, True], ids=["seen", "covered"])
def test_a_cup_that_was_let_go_of_was_taken_along_and_is_not_in_the_hand(hidden: bool) -> None:
    found = object_of(replace(LEFT_THERE, hidden=lambda number, t: hidden and 0.55 < t < 1.5))
    assert (found.taken_along, found.in_hand_at_end) == (True, False)


@pytest.mark.parametrize("until_s", [-0.4, 0.3])
def test_a_cup_that_is_covered_only_before_the_action_is_not_carried_in_it(until_s: float) -> None:
    """It was brought in a hand that covered it."""
    brought = moving((-0.9, (0.3, 0.0, 0.3)), (until_s - 0.1, CUP), (0.6, CUP), (1.4, PUSHED))
    hand = moving((-0.9, (0.3, 0.06, 0.3)), (until_s - 0.1, ABOVE_CUP), (0.6, ABOVE_CUP), (1.4, (0.1, 0.06, 0.66)))
    found = object_of(Scene(right_hand=hand, objects={1: brought}, hidden=lambda _, t: -0.85 < t < until_s))
    assert (found.taken_along, found.carried) == (True, until_s > 0)


def test_a_cup_that_is_held_still_is_in_the_hand_and_was_not_taken_along() -> None:
    lifted_before = moving((-0.9, (0.1, 0.0, 0.45)), (-0.3, LIFTED))
    hand = moving((-0.9, (0.1, 0.06, 0.45)), (-0.3, (0.1, 0.26, 0.45)))
    found = object_of(Scene(right_hand=hand, objects={1: lifted_before}))
    assert (found.taken_along, found.in_hand_at_end) == (False, True)


def test_a_cup_that_was_touched_was_neither_taken_along_nor_is_in_the_hand() -> None:
    found = object_of(TOUCHING)
    assert (found.taken_along, found.in_hand_at_end) == (False, False)


def test_an_occluded_cup_has_no_known_orientation() -> None:
    found = object_of(replace(LIFTING, hidden=lambda number, t: t > 0.75))
    assert found.pose is not None
    assert np.allclose(found.pose.position_m, LIFTING.stance.camera(LIFTED), atol=0.02)
    assert found.pose.quaternion_xyzw is None
    assert found.last_seen_ns is not None and at(0.7) < found.last_seen_ns <= at(0.75)


def test_where_a_cup_is_does_not_depend_on_how_far_away_the_body_seems() -> None:
    """The body stands half a decimetre nearer than it is: fusion aligns the cup in depth, but not its pose."""
    scene = acting_on(CUP, LIFTED)
    postures = [p.model_copy(update={"depth_std_m": 0.15}) for p in replace(scene, stance=scene.stance).postures()]
    nearer = [
        p.model_copy(
            update={"ego_from_camera": geometry.flat(geometry.from_flat(p.ego_from_camera or []) @ _towards(0.05))}
        )
        for p in postures
    ]
    event = event_of(*nearer, *scene.sightings(), action("lift"))
    assert event.object is not None and event.object.pose is not None
    assert np.allclose(event.object.pose.position_m, scene.stance.camera(LIFTED), atol=1e-6)


def _towards(by_m: float) -> np.ndarray:
    transform = np.eye(4)
    transform[2, 3] = by_m
    return transform


def test_no_orientation_is_made_up_of_what_is_none() -> None:
    for none in ([0.0] * 4, [1e308] * 4):
        found = object_of(LIFTING, quaternion=none)
        assert found.pose is not None and found.pose.quaternion_xyzw is None


def world_from_camera(turn_rad: float, tilt_rad: float, place: tuple[float, float, float]) -> np.ndarray:
    (s, c), (st_, ct) = ((np.sin(a), np.cos(a)) for a in (turn_rad, tilt_rad))
    transform = np.eye(4)
    transform[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, ct, -st_], [0, st_, ct]]
    )
    transform[:3, 3] = place
    return transform


angle = st.floats(-3.1, 3.1)


def test_the_transform_of_one_camera_is_not_taken_for_that_of_several() -> None:
    identity = geometry.flat(np.eye(4))
    assert Settings(sensor="left", world_from_camera=identity).fixed_from_camera is not None
    with pytest.raises(ValidationError, match="Then set world-from-camera to world-{sensor}.txt"):
        Settings(sensor="left,right", world_from_camera=identity)


def test_each_of_several_sensors_reads_the_transform_of_its_own_camera(
    tmp_path: File, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number, sensor in enumerate(("left", "right")):
        np.savetxt(tmp_path / f"world-{sensor}.txt", world_from_camera(0.0, 0.0, (number, 0.0, 0.0)))
    monkeypatch.setenv("ACTUM_WORLD_FROM_CAMERA", str(tmp_path / "world-{sensor}.txt"))
    for sensors in (["left", "right"], ["right"]):
        each = from_command_line(Settings, "action_fusion", ["--sensor", ",".join(sensors)]).of_each_sensor
        found = [own.fixed_from_camera for own in each]
        assert [own.sensor for own in each] == sensors
        assert [transform[0, 3] for transform in found if transform is not None] == [
            {"left": 0.0, "right": 1.0}[sensor] for sensor in sensors
        ]
    flagged = ["--sensor", "left", "--world-from-camera", str(tmp_path / "world-{sensor}.txt")]
    assert from_command_line(Settings, "action_fusion", flagged).fixed_from_camera is not None
    (tmp_path / "world-right.txt").unlink()
    both = Settings(sensor="left,right")
    with pytest.raises(ValueError, match=r"world-right\.txt' is neither a list of numbers nor a readable file"):
        _ = both.of_each_sensor


@settings(max_examples=20)  # each one runs a whole scene
@given(angle, angle, st.tuples(*[st.floats(-5.0, 5.0)] * 3))
def test_the_fixed_frame_is_where_the_setting_has_it(turn: float, tilt: float, place: Place) -> None:
    transform = world_from_camera(turn, tilt, place)
    found = object_of(LIFTING, world_from_camera=geometry.flat(transform), world_frame="robot_base")
    assert found.pose is not None and found.fixed_pose is not None
    assert (found.pose.frame, found.fixed_pose.frame) == ("camera", "robot_base")
    assert np.allclose(found.fixed_pose.position_m, geometry.apply(transform, np.array(found.pose.position_m)))
    turned = rotation_of(found.fixed_pose.quaternion_xyzw or [])
    assert np.allclose(turned, transform[:3, :3] @ rotation_of(TURNED), atol=1e-6)


SHIFTED = "1 0 0 0.5  0 1 0 0  0 0 1 -2  0 0 0 1"


@pytest.mark.parametrize(
    "text", [SHIFTED, f"[{', '.join(SHIFTED.split())}]", "[[1,0,0,.5],[0,1,0,0],[0,0,1,-2e0],[0,0,0,1]]", "FILE"]
)
def test_the_transform_is_16_numbers_or_a_file_of_them(
    text: str, tmp_path: File, monkeypatch: pytest.MonkeyPatch
) -> None:
    np.savetxt(tmp_path / "world.txt", np.array(SHIFTED.split(), dtype=float).reshape(4, 4))
    given_text = str(tmp_path / "world.txt") if text == "FILE" else text
    expected = [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, -2, 0, 0, 0, 1]
    monkeypatch.setenv("ACTUM_WORLD_FROM_CAMERA", given_text)
    found = Settings().fixed_from_camera
    assert found is not None and found.ravel().tolist() == expected
    monkeypatch.delenv("ACTUM_WORLD_FROM_CAMERA")
    flagged = Settings(_cli_parse_args=["--world-from-camera", given_text]).fixed_from_camera  # type: ignore[call-arg]
    assert flagged is not None and flagged.ravel().tolist() == expected


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("1 2 3", "is not a rigid transform: give the 16 numbers"),
        (
            "nowhere.txt",
            "'nowhere.txt' is neither a list of numbers nor a readable file .* No such file .*: give the 16 numbers",
        ),
        (SHIFTED.replace("1", "2"), "not a rigid transform"),
        (SHIFTED.replace("0.5", "nan"), "not a rigid transform"),
        (SHIFTED.replace("0.5", "1e300"), "not a rigid transform"),
    ],
)
def test_what_is_no_transform_is_refused_by_name(text: str, complaint: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ACTUM_WORLD_FROM_CAMERA", text)
    with pytest.raises(ValidationError, match=complaint):
        Settings()


def test_a_thing_pointed_at_is_where_it_stands() -> None:
    scene = Scene(objects={1: still((0.3, 0.2, 1.2))})
    found = object_of(replace(scene, right_hand=still((0.22, 0.45, 0.5))), "point", pointing_limit_deg=170.0)
    assert found.pose is not None
    assert np.allclose(found.pose.position_m, scene.stance.camera((0.3, 0.2, 1.2)))
    assert (found.taken_along, found.in_hand_at_end) == (False, False)
