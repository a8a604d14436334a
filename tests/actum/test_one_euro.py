"""The One-Euro filter: quiet at rest, and in motion never later than one frame."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.filters import OneEuro

FRAME_S = 1 / 30
FRAME_NS = 33_333_333


def filtered(points: np.ndarray, interval_ns: int = FRAME_NS) -> np.ndarray:
    low_pass = OneEuro()
    return np.array([low_pass.step(i * interval_ns, point) for i, point in enumerate(points)])


@given(speed_mps=st.floats(0.3, 3.0), heading=st.floats(0, 6.28))
def test_a_steady_motion_lags_by_less_than_a_frame(speed_mps: float, heading: float) -> None:
    velocity = speed_mps * np.array([np.cos(heading), np.sin(heading), 0.0])
    points = np.arange(60)[:, None, None] * FRAME_S * velocity
    lag_s = np.linalg.norm(points[-1] - filtered(points)[-1]) / speed_mps
    assert 0 < lag_s <= FRAME_S


def test_what_rests_stays_and_its_noise_is_halved() -> None:
    rest = np.full((90, 15, 3), 0.7)
    assert filtered(rest) == pytest.approx(rest)
    noise = np.random.default_rng(0).normal(0, 0.004, rest.shape)
    assert filtered(rest + noise)[30:].std() < 0.5 * noise.std()


@given(shift=st.floats(-5, 5))
def test_it_does_not_matter_where_it_happens(shift: float) -> None:
    points = np.random.default_rng(1).normal(0, 0.1, (20, 15, 3))
    assert filtered(points + shift) == pytest.approx(filtered(points) + shift, abs=1e-9)


def test_after_a_gap_it_begins_anew() -> None:
    low_pass = OneEuro()
    low_pass.step(0, np.zeros((1, 3)))
    assert low_pass.step(600_000_000, np.ones((1, 3))).tolist() == [[1.0, 1.0, 1.0]]
    assert low_pass.step(633_000_000, np.zeros((1, 3)))[0, 0] > 0
