from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from actum import geometry, standard_body
from actum.skeletons import INDEX
from people import STANDING, lacking, reaching

ANGLES = st.floats(-np.pi, np.pi)
SHIFTS = st.floats(-3, 3)
SIZES = st.floats(0.5, 1.5)
PEOPLE = st.builds(lambda seed: STANDING + np.random.default_rng(seed).normal(0, 0.05, (15, 3)), st.integers(0, 10**6))
AXES = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda axis: np.linalg.norm(axis) > 0.1)


def turned(joints: np.ndarray, heading: float, shift: tuple[float, float, float], size: float = 1.0) -> np.ndarray:
    """Move, turn about the vertical and scale a person."""
    c, s = np.cos(heading), np.sin(heading)
    return size * joints @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T + np.array(shift)


def rotated(joints: np.ndarray, axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """Turn about any axis through the camera (Rodrigues)."""
    unit = np.array(axis) / np.linalg.norm(axis)
    around = np.cross(unit, joints)
    return joints + np.sin(angle) * around + (1 - np.cos(angle)) * np.cross(unit, around)


def scaled_ego(joints: np.ndarray) -> np.ndarray:
    standard = standard_body.scaled(joints)
    return geometry.apply(geometry.ego_from_camera(standard), standard)


def hips_and_torso(torso_m: list[float]) -> np.ndarray:
    """Hips 0.4 m apart along x, 2 m away."""
    joints = np.zeros((15, 3))
    joints[INDEX["right_hip"]], joints[INDEX["left_hip"]] = [-0.1, 0.0, 2.0], [0.3, 0.0, 2.0]
    joints[INDEX["torso"]] = torso_m
    return joints


def test_the_origin_is_the_torsos_projection_on_the_hip_line() -> None:
    joints = hips_and_torso([0.05, -0.25, 2.0])
    ego = geometry.ego_from_camera(joints)
    np.testing.assert_allclose(geometry.apply(ego, np.array([0.05, 0.0, 2.0])), 0, atol=1e-12)
    np.testing.assert_allclose(geometry.apply(ego, joints[INDEX["torso"]]), [0, 0.25, 0], atol=1e-12)
    np.testing.assert_allclose(geometry.apply(ego, joints[INDEX["left_hip"]]), [0.25, 0, 0], atol=1e-12)


def test_the_axes_lean_with_the_trunk() -> None:
    """The torso 0.3 m above the hips and 0.4 m nearer to the camera: a trunk of 0.5 m, leaning forward."""
    left, up, forward = geometry.ego_from_camera(hips_and_torso([0.05, -0.3, 1.6]))[:3, :3]
    np.testing.assert_allclose(left, [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(up, [0, -0.6, -0.8], atol=1e-12)
    np.testing.assert_allclose(forward, [0, 0.8, -0.6], atol=1e-12)


@given(PEOPLE, ANGLES, st.tuples(SHIFTS, SHIFTS, SHIFTS), SIZES, AXES, ANGLES)
def test_a_posture_knows_neither_the_actors_place_nor_how_the_camera_is_held_and_a_scaled_one_no_size(
    person: np.ndarray,
    heading: float,
    shift: tuple[float, float, float],
    size: float,
    axis: tuple[float, float, float],
    angle: float,
) -> None:
    seen = rotated(turned(person, heading, shift, size), axis, angle)
    metric, unmoved = (geometry.apply(geometry.ego_from_camera(joints), joints) for joints in (seen, person))
    np.testing.assert_allclose(metric, size * unmoved, atol=1e-9)
    np.testing.assert_allclose(scaled_ego(seen), scaled_ego(person), atol=1e-9)


def test_scaling_keeps_each_bones_direction_and_gives_it_its_length() -> None:
    standard = standard_body.scaled(STANDING)
    for parent, child, length_m in standard_body.BONES:
        before, after = STANDING[child] - STANDING[parent], standard[child] - standard[parent]
        np.testing.assert_allclose(after, before / np.linalg.norm(before) * length_m, atol=1e-12)


@given(ANGLES, st.tuples(SHIFTS, SHIFTS, SHIFTS))
def test_the_transform_is_rigid_and_its_inverse_undoes_it(heading: float, shift: tuple[float, float, float]) -> None:
    ego = geometry.ego_from_camera(turned(STANDING, heading, shift))
    np.testing.assert_allclose(ego[:3, :3] @ ego[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(ego[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose(geometry.invert(ego) @ ego, np.eye(4), atol=1e-12)


TURNED_AND_SHIFTED = np.array([[0, -1, 0, 0.5], [1, 0, 0, -2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
SPOILT = {
    "a mirror image": lambda rigid: rigid @ np.diag([1, 1, -1, 1.0]),
    "twice the size": lambda rigid: rigid @ np.diag([2, 2, 2, 1.0]),
    "sheared": lambda rigid: rigid @ (np.eye(4) + 0.01 * np.eye(4, k=1)),
    "a projection": lambda rigid: rigid + np.diag([0, 0, -1.0], k=-1),
    "another last number": lambda rigid: rigid + np.diag([0, 0, 0, 1.0]),
    "too far": lambda rigid: rigid + 11 * np.eye(4, k=3),
    "not finite": lambda rigid: np.where(np.eye(4, k=3), np.nan, rigid),
}


@given(ANGLES, st.tuples(SHIFTS, SHIFTS, SHIFTS))
def test_rounding_to_four_decimals_leaves_a_transform_rigid(heading: float, shift: tuple[float, float, float]) -> None:
    ego = geometry.ego_from_camera(turned(STANDING, heading, shift))
    assert geometry.is_rigid(ego.round(4), furthest_m=10)


@pytest.mark.parametrize("spoil", SPOILT.values(), ids=SPOILT)
def test_what_is_no_turn_and_shift_is_not_rigid(spoil) -> None:
    assert geometry.is_rigid(TURNED_AND_SHIFTED, furthest_m=10)
    assert not geometry.is_rigid(spoil(TURNED_AND_SHIFTED), furthest_m=10)


def test_a_joint_is_scaled_where_its_way_from_the_torso_is_known() -> None:
    standard = standard_body.scaled(lacking(STANDING, "left_shoulder", "right_elbow", "right_foot"))
    unknown = ["left_shoulder", "left_elbow", "left_hand", "right_elbow", "right_hand", "right_foot"]
    np.testing.assert_array_equal(standard, lacking(standard_body.scaled(STANDING), *unknown))


@given(
    PEOPLE, ANGLES, st.tuples(SHIFTS, SHIFTS, SHIFTS), SIZES, st.sampled_from([["left_hip"], ["left_hip", "right_hip"]])
)
def test_without_a_hip_the_shoulders_make_the_frame(
    person: np.ndarray, heading: float, shift: tuple[float, float, float], size: float, lost: list[str]
) -> None:
    """The hips' line is the shoulders', as far below the torso as the neck is above it."""
    moved = lacking(turned(person, heading, shift, size), *lost)
    ego = geometry.ego_from_camera(moved)
    here = geometry.apply(ego, moved)
    shoulders = here[INDEX["left_shoulder"]] - here[INDEX["right_shoulder"]]
    np.testing.assert_allclose(shoulders / np.linalg.norm(shoulders), [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(here[INDEX["torso"], [0, 2]], 0, atol=1e-9)
    np.testing.assert_allclose(here[INDEX["neck"], 1:], [2 * here[INDEX["torso"], 1], 0], atol=1e-9)
    unmoved = lacking(person, *lost)
    np.testing.assert_allclose(here, size * geometry.apply(geometry.ego_from_camera(unmoved), unmoved), atol=1e-9)


def test_the_stand_in_for_unknown_hips_is_near_them() -> None:
    whole, legless = (geometry.ego_from_camera(j) for j in (STANDING, lacking(STANDING, "left_hip", "right_hip")))
    cosines = np.einsum("ij,ij->i", whole[:3, :3], legless[:3, :3])
    assert np.degrees(np.arccos(cosines.min())) < 5
    assert np.linalg.norm(geometry.apply(whole, geometry.invert(legless)[:3, 3])) < 0.05


def test_a_stack_of_frames_may_know_the_hips_in_some() -> None:
    frames = np.stack([STANDING, lacking(STANDING, "left_hip"), reaching(1.0)])
    np.testing.assert_array_equal(
        geometry.ego_from_camera(frames), [geometry.ego_from_camera(joints) for joints in frames]
    )


def test_upright_is_left_up_and_forward_from_the_torso() -> None:
    """The torso 2 m away; someone facing the camera has their left on camera +x and their front towards it."""
    joints = np.tile([0.5, 0.3, 2.0], (15, 1))
    joints[INDEX["left_hand"]] += [0.1, 0.0, 0.0]
    joints[INDEX["head"]] += [0.0, -0.6, 0.0]
    joints[INDEX["right_hand"]] += [0.0, 0.0, -0.3]
    facing = geometry.upright(joints, 1.0, 0.0)
    np.testing.assert_allclose(facing[INDEX["left_hand"]], [0.1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(facing[INDEX["head"]], [0, 0.6, 0], atol=1e-12)
    np.testing.assert_allclose(facing[INDEX["right_hand"]], [0, 0, 0.3], atol=1e-12)
    sideways = geometry.upright(joints, 0.0, -1.0)
    np.testing.assert_allclose(sideways[INDEX["right_hand"]], [0.3, 0, 0], atol=1e-12)
    np.testing.assert_allclose(sideways[INDEX["left_hand"]], [0, 0, -0.1], atol=1e-12)


def test_joints_without_a_frame_are_refused() -> None:
    with pytest.raises(geometry.DegenerateError, match="hips"):
        geometry.ego_from_camera(np.zeros((15, 3)))
    without_hips = lacking(np.zeros((15, 3)), "left_hip", "right_hip")
    with pytest.raises(geometry.DegenerateError, match="shoulders in place of missing hips"):
        geometry.ego_from_camera(without_hips)
    with pytest.raises(geometry.DegenerateError, match="are at the same position"):
        standard_body.scaled(np.ones((15, 3)))


def test_flat_transforms_are_row_major() -> None:
    transform = np.arange(16.0).reshape(4, 4)
    assert geometry.flat(transform) == [float(i) for i in range(16)]
    np.testing.assert_array_equal(geometry.from_flat(geometry.flat(transform)), transform)


def camera_tilted(pitch_deg: float, roll_deg: float) -> np.ndarray:
    """Axes (3, 3) of a level camera as one sees them that looks up by an angle and is turned clockwise."""
    pitch, roll = np.radians(pitch_deg), np.radians(roll_deg)
    looking_up = [[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]]
    clockwise = [[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
    return np.array(clockwise) @ looking_up


@given(st.floats(-80, 80), st.one_of(st.floats(-180, 180), st.sampled_from([-180.0, -90.0, 90.0, 180.0])), SIZES)
def test_however_a_camera_hangs_its_line_of_sight_stays_forward(pitch_deg: float, roll_deg: float, size: float) -> None:
    """Untilting undoes roll and pitch, and nothing else; upside down, too, left stays left of who faces the camera."""
    camera_from_level = camera_tilted(pitch_deg, roll_deg)
    level_from_camera = geometry.untilted_from_camera(size * camera_from_level @ [0, -1, 0])
    x, _, z = level_from_camera @ [0, 0, 1]
    assert x == 0
    assert z > 0
    np.testing.assert_allclose(level_from_camera @ camera_from_level, np.eye(3), atol=1e-9)


TINIEST, LARGEST = 5e-324, np.finfo(np.float64).max


@given(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3).filter(any))
@example((TINIEST, TINIEST, 1.0))
@example((-TINIEST, 3 * TINIEST, -1.0))
@example((0.0, TINIEST, TINIEST))
@example((TINIEST, -2 * TINIEST, 3 * TINIEST))
@example((LARGEST, LARGEST, -LARGEST))
@example((TINIEST, LARGEST, 1.0))
@example((1e-17, -1e-16, 1.0))
@example((1e-16, 3e-16, 1.0))
@example((1e-160, -1e-160, 1e-160))
def test_untilting_is_a_rotation_that_brings_up_to_where_a_level_camera_has_it(up: tuple[float, float, float]) -> None:
    level_from_camera = geometry.untilted_from_camera(up)
    of_length_1 = np.array([float(Fraction(component) / Fraction(max(map(abs, up)))) for component in up])
    of_length_1 /= np.linalg.norm(of_length_1)
    np.testing.assert_allclose(level_from_camera @ of_length_1, [0, -1, 0], atol=1e-12)
    np.testing.assert_allclose(level_from_camera @ level_from_camera.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(level_from_camera) == pytest.approx(1)


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (-0.0, -0.0, -1.0), (TINIEST, TINIEST, 1.0), (1e-17, 1e-17, -1.0)])
def test_a_camera_that_looks_straight_up_or_down_is_only_pitched(up: tuple[float, float, float]) -> None:
    """Also where rounding has left something across, which tells nothing of the roll."""
    level_from_camera = geometry.untilted_from_camera(up)
    np.testing.assert_allclose(level_from_camera @ up, [0, -1, 0], rtol=0, atol=1e-16)
    np.testing.assert_array_equal(level_from_camera @ [1, 0, 0], [1, 0, 0])
