"""How a camera is tilted is found from one person who stands straight and still."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum_calibrator.up_direction import FEWEST_FRAMES, MOST_BEND_DEG, MOST_SWAY_DEG, UpDirectionEstimator
from people import FRAME_NS, STANDING, lacking, skeleton

Array = NDArray[np.float64]

FRAMES = 62
"""As many as it takes at FRAME_NS, which is a little less than a thirtieth of a second."""


def asked(*people: Array, frames: int = FRAMES, noise_m: float = 0.0) -> UpDirectionEstimator:
    """Offer the same people again and again."""
    estimator, rng = UpDirectionEstimator(), np.random.default_rng(0)
    for k in range(frames):
        estimator.offer(skeleton(k * FRAME_NS, *(joints + rng.normal(0, noise_m, (15, 3)) for joints in people)))
    return estimator


def rotation(axis: int, degrees: float) -> Array:
    """Turn column vectors about an axis."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(3)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn[one, one] = turn[other, other] = cos
    turn[other, one], turn[one, other] = sin, -sin
    return turn


def plumb() -> Array:
    """One whose neck is exactly above the feet."""
    joints = STANDING.copy()
    feet = (joints[INDEX["left_foot"]] + joints[INDEX["right_foot"]]) / 2
    joints[:, [0, 2]] += (feet - joints[INDEX["neck"]])[[0, 2]] * (np.arange(15) == INDEX["neck"])[:, None]
    return joints


@settings(deadline=None, max_examples=25)
@given(st.floats(-60, 60), st.floats(-60, 60))
def test_the_tilt_is_the_cameras(pitch_deg: float, roll_deg: float) -> None:
    camera_from_level = rotation(2, -roll_deg) @ rotation(0, -pitch_deg)
    found = asked(plumb() @ camera_from_level.T).up
    assert found is not None
    assert found.in_camera == pytest.approx(camera_from_level @ [0, -1, 0], abs=1e-9)


@pytest.mark.parametrize("degrees", [-20.0, 0.0, 12.0])
def test_pitch_is_up_and_roll_is_clockwise(degrees: float) -> None:
    """A camera that looks up sees who stands upright lean away; one turned clockwise, to the left."""
    looking_up, clockwise = (asked(plumb() @ rotation(axis, -degrees).T).up for axis in (0, 2))
    assert looking_up is not None
    assert clockwise is not None
    assert (looking_up.pitch_deg, looking_up.roll_deg) == pytest.approx((degrees, 0.0), abs=1e-9)
    assert (clockwise.pitch_deg, clockwise.roll_deg) == pytest.approx((0.0, degrees), abs=1e-9)
    assert np.sign(looking_up.in_camera[2]) == np.sign(degrees)
    assert np.sign(clockwise.in_camera[0]) == -np.sign(degrees)


def test_a_trackers_noise_averages_out() -> None:
    found = asked(plumb(), noise_m=0.015).up
    assert found is not None
    assert found.in_camera == pytest.approx([0, -1, 0], abs=0.01)
    assert 0 < found.sway_deg < MOST_SWAY_DEG


def seconds_until_found(rate_hz: float, joints: Array, longest_s: float = 20.0) -> float | None:
    """Offer the same person at a rate; return when it is found."""
    estimator = UpDirectionEstimator()
    for k in range(round(longest_s * rate_hz)):
        stamp_ns = round(k * SECOND_NS / rate_hz)
        estimator.offer(skeleton(stamp_ns, joints))
        if estimator.up is not None:
            return stamp_ns / SECOND_NS
    return None


@pytest.mark.parametrize("rate_hz", [30, 15, 5])
def test_it_takes_two_seconds_at_any_rate(rate_hz: int) -> None:
    found_s = seconds_until_found(rate_hz, plumb())
    assert found_s is not None
    assert 2.0 <= found_s <= 2.3


def test_of_a_slow_stream_it_takes_enough_frames() -> None:
    assert seconds_until_found(2.5, plumb()) == pytest.approx((FEWEST_FRAMES - 1) / 2.5)


def test_frames_with_gaps_between_them_are_nobody_who_stands_still() -> None:
    assert seconds_until_found(1.9, plumb(), 100.0) is None
    assert seconds_until_found(1 / 60, plumb(), 6000.0) is None


def test_who_comes_to_rest_is_judged_by_the_last_two_seconds_alone() -> None:
    estimator = UpDirectionEstimator()
    for k in range(1000):
        moving = k < 900
        estimator.offer(skeleton(k * FRAME_NS, plumb() @ rotation(2, 20 * np.sin(k / 5) if moving else 0).T))
        if estimator.up is not None:
            break
    assert estimator.up is not None
    assert 900 + 45 < k <= 900 + FRAMES
    assert estimator.up.in_camera == pytest.approx([0, -1, 0], abs=0.03)


@pytest.mark.parametrize("change", ["session_id", "agent", "gap", "clock set back"])
def test_what_went_before_a_change_does_not_count(change: str) -> None:
    estimator = asked(plumb(), frames=FRAMES - 1)
    first_ns = {"gap": FRAMES * FRAME_NS + SECOND_NS // 2, "clock set back": 0}.get(change, FRAMES * FRAME_NS)
    for k in range(FRAMES):
        assert estimator.up is None
        frame = skeleton(first_ns + k * FRAME_NS, plumb(), session_id="other" if change == "session_id" else "test")
        agents = [agent.model_copy(update={"agent": 2}) for agent in frame.agents]
        estimator.offer(frame.model_copy(update={"agents": agents}) if change == "agent" else frame)
    assert estimator.up is not None


def test_who_stands_right_is_told_to_stay_whatever_was_wrong_before() -> None:
    estimator = asked(bent(MOST_BEND_DEG + 20), frames=3)
    assert "stand straight" in estimator.instruction
    estimator.offer(skeleton(3 * FRAME_NS, plumb()))
    assert estimator.instruction.startswith("stay like that")


def bent(degrees: float) -> Array:
    """Bowed at the hips."""
    joints = plumb()
    hips = (joints[INDEX["left_hip"]] + joints[INDEX["right_hip"]]) / 2
    above = [k for name, k in INDEX.items() if not name.endswith(("hip", "knee", "foot"))]
    joints[above] = hips + (joints[above] - hips) @ rotation(0, degrees).T
    return joints


@pytest.mark.parametrize(
    ("people", "instruction"),
    [
        ((), "nobody is visible"),
        ((plumb(), plumb() + np.array([1, 0, 0])), "2 people are visible: only one person may be"),
        ((lacking(plumb(), "left_foot", "right_foot"),), "not visible: left_foot, right_foot; step back"),
        ((bent(MOST_BEND_DEG + 20),), "stand straight: the body is bent"),
        ((np.where(np.arange(15)[:, None] == INDEX["left_hip"], 1e400, plumb()),), "not visible: left_hip"),
        ((np.zeros((15, 3)),), "stand straight"),
    ],
)
def test_what_is_wrong_is_said(people: tuple[Array, ...], instruction: str) -> None:
    estimator = asked(*people)
    assert estimator.up is None
    assert instruction in estimator.instruction


def test_who_moves_is_asked_to_stand_still() -> None:
    estimator = UpDirectionEstimator()
    for k in range(2 * FRAMES):
        estimator.offer(skeleton(k * FRAME_NS, plumb() @ rotation(2, 5 * np.sin(k / 5)).T))
    assert estimator.up is None
    assert "the body sways by more than 1.5 degrees" in estimator.instruction


def test_an_interruption_begins_it_anew() -> None:
    estimator = asked(plumb(), frames=FRAMES - 1)
    estimator.offer(
        Skeleton(stamp_ns=FRAMES * FRAME_NS, sensor="kinect0", agents=[], valid=False, reason="camera lost")
    )
    assert estimator.instruction == "nobody is visible: camera lost"
    estimator.offer(skeleton((FRAMES + 1) * FRAME_NS, plumb()))
    assert estimator.up is None
