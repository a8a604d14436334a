"""The upright posture: scaled joints from the torso, up along gravity, turned by the smoothed heading.

Whose heading is steady is seen from the front, however they stand; whose heading sways is believed to face the camera.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from actum import standard_body
from actum.messages import Posture
from actum.skeletons import INDEX
from people import FRAME_NS, STANDING, lacking, reaching, skeleton, turned
from pose_preprocessor.heading import FACING_SD_RAD, FIRST_S, TIME_CONSTANT_S, VARIANCE_INFLATION, HeadingFilter
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

Array = NDArray[np.float64]

HEADINGS = st.floats(-np.pi, np.pi)
AWAY = st.floats(np.pi / 2 + 0.6, 3 * np.pi / 2 - 0.6)
"""Beyond a quarter turn, also for one who sways by 0.6 rad about it."""
SHIFTS = st.tuples(*[st.floats(-2, 2)] * 3)
SIZES = st.floats(0.7, 1.3)
SECOND_NS = 10**9
HIPS, SHOULDERS = ("left_hip", "right_hip"), ("left_shoulder", "right_shoulder")


def upright(frames: list[Array], first_ns: int = 0, step_ns: int = FRAME_NS) -> Array:
    """Each frame's upright joints (n, 15, 3)."""
    node = PosePreprocessor(PoseSettings.defaults())
    made = [p for i, joints in enumerate(frames) for p in node.handle(skeleton(first_ns + i * step_ns, joints))]
    assert all(isinstance(posture, Posture) and posture.valid and posture.upright for posture in made)
    return np.array([posture.upright for posture in made if isinstance(posture, Posture)])


def steady(frames: int = 15, seed: int = 0) -> list[Array]:
    """A reaching person whose limbs tremble and whose hips and shoulders stay where they are."""
    trunk = np.isin(np.arange(15), [INDEX[name] for name in ("torso", *HIPS, *SHOULDERS)])
    noise = np.where(trunk[:, None], 0.0, np.random.default_rng(seed).normal(0, 0.01, (frames, 15, 3)))
    return [reaching(i / frames) + noise[i] for i in range(frames)]


def elsewhere(frames: list[Array], heading: float, shift: tuple[float, ...] = (0, 0, 0), size: float = 1.0) -> Array:
    """The same person at another place, turned about the vertical as a whole, and larger or smaller."""
    about = frames[0][INDEX["torso"]]
    c, s = np.cos(heading), np.sin(heading)
    yaw = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    return np.array([about + size * (joints - about) @ yaw.T + np.array(shift) for joints in frames])


def moving(frames: int = 15, seed: int = 0) -> list[Array]:
    """A reaching person who sways about the vertical."""
    noise = np.random.default_rng(seed).normal(0, 0.01, (frames, 15, 3))
    return [turned(reaching(i / frames), 0.4 * np.sin(i / 3)) + noise[i] for i in range(frames)]


def angle(filtered: tuple[float, float]) -> float:
    """The heading that a direction to the left stands for; 0 faces the camera, a positive one is turned left."""
    return float(np.arctan2(filtered[1], filtered[0]))


def level(joints: Array) -> Array:
    """The person with hips and shoulders straight across."""
    straight = joints.copy()
    for left, right in (HIPS, SHOULDERS):
        straight[INDEX[left], 1:] = straight[INDEX[right], 1:]
    return straight


@given(HEADINGS)
def test_at_a_steady_heading_it_is_the_scaled_posture_seen_from_the_front(heading: float) -> None:
    (seen,) = upright([turned(level(STANDING), heading)])
    standard = standard_body.scaled(level(STANDING)) - STANDING[INDEX["torso"]]
    np.testing.assert_allclose(seen, standard * [1, -1, -1], atol=1e-12)


def test_left_is_left_up_is_up_and_forward_is_forward() -> None:
    seen = upright([turned(reaching(1.0), heading) for heading in np.linspace(0, 0.1, 5)])
    assert (seen[:, INDEX["left_hand"], 0] > 0.1).all()
    assert (seen[:, INDEX["right_shoulder"], 0] < -0.1).all()
    assert (seen[:, INDEX["head"], 1] > 0.4).all()
    assert (seen[:, INDEX["left_foot"], 1] < -0.8).all()
    assert (seen[:, INDEX["right_hand"], 2] > 0.4).all()
    np.testing.assert_array_equal(seen[:, INDEX["torso"]], 0)


def test_a_bow_stays_a_bow() -> None:
    """Up is along gravity, not along the trunk: the head of one who bows by 60 degrees comes forward and down."""
    bowed = level(STANDING)
    above = [INDEX[name] for name in ("head", "neck")]
    bowed[above] = bowed[INDEX["torso"]] + np.array([[0, -0.5, -np.sqrt(0.75)]]) * np.array([[0.44], [0.24]])
    shift = bowed[INDEX["neck"]] - STANDING[INDEX["neck"]]
    bowed[[INDEX[name] for name in SHOULDERS]] += shift
    (seen,) = upright([bowed])
    np.testing.assert_allclose(seen[INDEX["head"]], [0, 0.22, 0.44 * np.sqrt(0.75)], atol=1e-12)


@given(HEADINGS, SHIFTS, SIZES)
def test_place_heading_and_size_of_a_steady_body_leave_it_alone(
    heading: float, shift: tuple[float, ...], size: float
) -> None:
    """The camera's place and its yaw do, therefore."""
    frames = steady()
    np.testing.assert_allclose(upright([*elsewhere(frames, heading, shift, size)]), upright(frames), atol=1e-9)


@given(AWAY)
def test_the_heading_of_who_sways_leaves_it_alone_beyond_a_quarter_turn(heading: float) -> None:
    frames = moving()
    from_behind = upright([*elsewhere(frames, np.pi)])
    np.testing.assert_allclose(upright([*elsewhere(frames, heading)]), from_behind, atol=1e-9)


def test_the_heading_is_the_mean_of_hips_and_shoulders() -> None:
    twisted = STANDING.copy()
    for names, degrees in ((HIPS, 10), (SHOULDERS, 50)):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        twisted[INDEX[names[0]], [0, 2]] = 0.15 * np.array([c, s])
        twisted[INDEX[names[1]], [0, 2]] = -0.15 * np.array([c, s])
        twisted[[INDEX[name] for name in names], 1] = 0.0
    assert np.degrees(angle(HeadingFilter().step(0, twisted))) == pytest.approx(30)
    assert np.degrees(angle(HeadingFilter().step(0, lacking(twisted, *HIPS)))) == pytest.approx(50)
    assert np.degrees(angle(HeadingFilter().step(0, lacking(twisted, "left_shoulder")))) == pytest.approx(10)


def swaying(rate_hz: int, *headings_rad: float, seconds: int = 20) -> tuple[HeadingFilter, float]:
    """One who takes these headings in turn, frame by frame: their filter, and the heading that it has at the end."""
    heading, persons = HeadingFilter(), [turned(level(STANDING), each) for each in headings_rad]
    for i in range(seconds * rate_hz):
        left = heading.step(i * SECOND_NS // rate_hz, persons[i % len(persons)])
    return heading, angle(left)


def drawn(yaw_rad: float, variance_rad2: float) -> float:
    """The yaw shrunk towards facing the camera, as its variance says."""
    variance = VARIANCE_INFLATION * variance_rad2
    return yaw_rad * (1 - max(np.cos(yaw_rad), 0) * variance / (variance + FACING_SD_RAD**2))


@settings(max_examples=30)
@given(st.floats(-1.2, 1.2), st.floats(0.01, 0.3), st.sampled_from([15, 30, 60]))
def test_a_swaying_heading_is_drawn_towards_the_camera(heading_rad: float, sway_rad: float, rate_hz: int) -> None:
    """From side to side by σ at each frame: the mean follows each by a / (2 - a), and lies off by the rest."""
    _, found = swaying(rate_hz, heading_rad - sway_rad, heading_rad + sway_rad)
    share = 1 - np.exp(-1 / rate_hz / TIME_CONSTANT_S)
    follows_rad = np.arctan(share / (2 - share) * np.tan(sway_rad))
    yaw_rad = heading_rad + follows_rad
    assert found == pytest.approx(drawn(yaw_rad, (sway_rad - follows_rad) ** 2), abs=1e-6)
    assert abs(found) <= abs(yaw_rad)


def test_who_sways_by_ten_degrees_is_believed_about_half() -> None:
    """Twice its variance is then about that of how people stand, 15°."""
    _, found = swaying(100, np.radians(20 - 15 / 2**0.5), np.radians(20 + 15 / 2**0.5))
    assert np.degrees(found) == pytest.approx(20 * (1 - 0.5 * np.cos(np.radians(20))), abs=0.2)


@settings(max_examples=20)
@given(AWAY, st.floats(0.0, 0.5))
def test_beyond_a_quarter_turn_a_swaying_heading_is_itself(heading_rad: float, sway_rad: float) -> None:
    _, found = swaying(30, heading_rad - sway_rad, heading_rad + sway_rad)
    share = 1 - np.exp(-1 / 30 / TIME_CONSTANT_S)
    yaw_rad = heading_rad + np.arctan(share / (2 - share) * np.tan(sway_rad))
    assert np.remainder(found - yaw_rad + 1, 2 * np.pi) == pytest.approx(1, abs=1e-6)


def test_a_turn_in_front_of_the_camera_is_believed_the_more_the_longer_it_lasts() -> None:
    """The variance is that of the way from the mean to the new heading, and fades with it."""
    heading, person, turn_rad, variance_rad2 = HeadingFilter(), level(STANDING), np.radians(40), 0.0
    for i in range(300):
        heading.step(i * SECOND_NS // 30, person)
    rest, kept, found = 1.0, np.exp(-1 / 30 / TIME_CONSTANT_S), [0.0]
    for i in range(300, 600):
        found.append(angle(heading.step(i * SECOND_NS // 30, turned(person, turn_rad))))
        rest *= kept
        yaw_rad = np.arctan2((1 - rest) * np.sin(turn_rad), rest + (1 - rest) * np.cos(turn_rad))
        variance_rad2 = kept * variance_rad2 + (1 - kept) * (turn_rad - yaw_rad) ** 2
        assert found[-1] == pytest.approx(drawn(yaw_rad, variance_rad2), abs=1e-6)
    assert found == sorted(found)
    assert found[-1] == pytest.approx(turn_rad, rel=0.01)


def test_at_first_the_heading_is_the_mean_of_what_was_seen() -> None:
    """Frames at 30 Hz count the same as long as the mean is quicker than the filter; seen from behind it stays so."""
    heading, person = HeadingFilter(), level(STANDING)
    headings_rad = np.random.default_rng(3).uniform(np.pi - 1, np.pi + 1, 20)
    for i, heading_rad in enumerate(headings_rad):
        left = heading.step(round(i * FIRST_S * SECOND_NS), turned(person, heading_rad))
        seen = headings_rad[: i + 1]
        assert angle(left) == pytest.approx(np.arctan2(np.sin(seen).sum(), np.cos(seen).sum()), abs=1e-6)


def test_the_filter_does_not_know_the_frame_rate() -> None:
    """Once the mean has given way to the filter, a hundred steps go as far as one; seen from behind it shows."""
    fine, coarse, person = HeadingFilter(), HeadingFilter(), level(STANDING)
    for i in range(11):
        fine.step(i * SECOND_NS // 2, turned(person, np.pi))
        coarse.step(i * SECOND_NS // 2, turned(person, np.pi))
    late_ns = 5 * SECOND_NS
    for i in range(1, 101):
        left = fine.step(late_ns + i * SECOND_NS // 200, turned(person, np.pi - 1.0))
    assert left == pytest.approx(coarse.step(late_ns + SECOND_NS // 2, turned(person, np.pi - 1.0)))


@pytest.mark.parametrize(("gap_ns", "expected"), [(SECOND_NS // 2, False), (SECOND_NS // 2 + 1, True)])
def test_the_heading_begins_anew_after_a_gap(gap_ns: int, expected: bool) -> None:
    heading, person = HeadingFilter(), level(STANDING)
    for i in range(60):
        heading.step(i * FRAME_NS, person)
    left = heading.step(59 * FRAME_NS + gap_ns, turned(person, 1.0))
    assert (angle(left) == pytest.approx(1.0)) is expected


def test_what_swayed_before_a_gap_is_forgotten() -> None:
    heading, found = swaying(30, 0.2, 1.0, seconds=2)
    assert found < 0.4
    after_ns = 2 * SECOND_NS + SECOND_NS
    assert angle(heading.step(after_ns, turned(level(STANDING), 0.6))) == pytest.approx(0.6)


def test_another_session_begins_anew() -> None:
    node, person = PosePreprocessor(PoseSettings.defaults()), level(STANDING)
    frames = [skeleton(0, person), skeleton(FRAME_NS, turned(person, 2.0), session_id="other")]
    first, other = [p for frame in frames for p in node.handle(frame) if isinstance(p, Posture)]
    np.testing.assert_allclose(np.array(other.upright), np.array(first.upright), atol=1e-12)


def test_one_who_lies_on_the_side_keeps_the_last_heading() -> None:
    """Without one they face the camera."""
    lying = STANDING[INDEX["torso"]] + (level(STANDING) - STANDING[INDEX["torso"]])[:, [1, 0, 2]]
    heading = HeadingFilter()
    assert heading.step(0, lying) == (1.0, 0.0)
    turned_left = heading.step(SECOND_NS, turned(level(STANDING), 0.7))
    assert angle(turned_left) == pytest.approx(0.7)
    assert heading.step(2 * SECOND_NS, lying) == turned_left
    for i in range(1, 61):
        assert heading.step(2 * SECOND_NS + i * FRAME_NS, lying) == turned_left


def test_who_lies_down_on_the_side_does_not_sway() -> None:
    lying = STANDING[INDEX["torso"]] + (level(STANDING) - STANDING[INDEX["torso"]])[:, [1, 0, 2]]
    heading, _ = swaying(30, 0.7, seconds=1)
    for i in range(30, 90):
        assert angle(heading.step(i * SECOND_NS // 30, lying)) == pytest.approx(0.7)


def test_each_person_has_a_heading_of_their_own() -> None:
    node, person = PosePreprocessor(PoseSettings.defaults()), level(STANDING)
    for i in range(20):
        drift = np.array([1.0, 0.0, 1e-6 * i])
        frame = skeleton(i * FRAME_NS, turned(person, 0.5) + drift, turned(person, -1.5) - drift)
        first, second = (posture for posture in node.handle(frame) if isinstance(posture, Posture))
    np.testing.assert_allclose(np.array(first.upright), np.array(second.upright), atol=1e-9)


@given(st.floats(-75, 75), st.floats(-75, 75))
@settings(deadline=None, max_examples=20)
def test_a_camera_that_says_how_it_is_tilted_sees_the_postures_of_a_level_one(
    pitch_deg: float, roll_deg: float
) -> None:
    """But for how the person is turned from it: a tilted camera's line of sight is another."""
    camera_from_level = tilted(pitch_deg, roll_deg)
    up_in_camera = (camera_from_level @ [0.0, -1.0, 0.0]).tolist()
    frames = [skeleton(k * FRAME_NS, joints @ camera_from_level.T) for k, joints in enumerate(steady())]
    node = PosePreprocessor(PoseSettings.defaults())
    made = [
        posture
        for frame in frames
        for posture in node.handle(frame.model_copy(update={"up_in_camera": up_in_camera}))
        if isinstance(posture, Posture)
    ]
    assert all(posture.up_in_camera == up_in_camera for posture in made)
    np.testing.assert_allclose(np.array([posture.upright for posture in made]), upright(steady()), atol=1e-6)


def tilted(pitch_deg: float, roll_deg: float) -> Array:
    """What a camera sees that looks up by an angle and is turned clockwise, (3, 3), of what a level one does."""
    pitch, roll = np.radians(pitch_deg), np.radians(roll_deg)
    looking_up = np.array([[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]])
    clockwise = np.array([[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
    turned_camera: Array = clockwise @ looking_up
    return turned_camera
