"""Background: movement of people whom nobody taught anything, and the windows of it that training looks at."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.free_people.__main__ import made

from actum.node import SECOND_NS
from actum_model_trainer import background
from actum_model_trainer.background import FEWEST_FRAMES, LEAST_SPEED_M_S, SHIPPED, save, shipped, windows_of
from actum_model_trainer.samples import LabelledStream

DURATIONS_S = np.array([1.0, 2.0])


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def standing(seconds: float, motion_m: float = 0.0) -> LabelledStream:
    count = round(30 * seconds)
    stamps_ns = np.arange(count) * SECOND_NS // 30
    still = np.zeros((count, 15, 3))
    return LabelledStream(stamps_ns, np.full((count, 5), motion_m), still, still, (), "1", "x", 1)


def test_the_shipped_background_is_half_an_hour_of_many_people() -> None:
    streams = shipped()
    minutes = sum(float(np.ptp(stream.stamps_ns)) for stream in streams) / SECOND_NS / 60
    assert minutes == pytest.approx(32, abs=0.5)
    assert len({stream.person for stream in streams}) == len(streams) == 16
    assert not any(stream.segments for stream in streams)
    assert SHIPPED.stat().st_size < 3_000_000


def test_what_is_saved_is_read_again_to_the_millimetre(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = replace(
        standing(3.0), postures=rng().normal(size=(90, 15, 3)), velocities=rng(1).normal(size=(90, 15, 3)),
        motion=rng(2).random((90, 5)),
    )  # fmt: skip
    save([one, standing(1.0)], tmp_path / "background.npz")
    monkeypatch.setattr(background, "SHIPPED", tmp_path / "background.npz")
    first, second = shipped.__wrapped__()
    np.testing.assert_allclose(first.postures, one.postures[::2], atol=0.0006)
    np.testing.assert_allclose(first.velocities, one.velocities[::2], atol=0.0006)
    np.testing.assert_allclose(first.motion, one.motion[::2] + one.motion[1::2], atol=0.0006)
    assert first.stamps_ns.tolist() == one.stamps_ns[::2].tolist()
    assert len(second.stamps_ns) == 15


def test_windows_last_about_as_long_as_what_was_taught() -> None:
    windows = windows_of(shipped(), DURATIONS_S, 200, rng())
    assert len(windows) == 200
    durations_s = np.array([np.ptp(window.stamps_ns) for window in windows]) / SECOND_NS
    assert np.median(durations_s) == pytest.approx(np.sqrt(2), rel=0.2)
    assert all(len(window.stamps_ns) >= FEWEST_FRAMES for window in windows)
    speeds_m_s = np.array([window.motion.sum() for window in windows]) / durations_s
    assert speeds_m_s.min() > 0.9 * LEAST_SPEED_M_S


def test_the_same_seed_draws_the_same_windows() -> None:
    one, same, other = (windows_of(shipped(), DURATIONS_S, 5, rng(seed)) for seed in (1, 1, 2))
    assert [w.stamps_ns.tolist() for w in one] == [w.stamps_ns.tolist() for w in same]
    assert [w.stamps_ns.tolist() for w in one] != [w.stamps_ns.tolist() for w in other]


@pytest.mark.parametrize("streams", [[], [standing(0.1, 1.0)], [standing(30.0)]], ids=["none", "too short", "standing"])
def test_where_nobody_moves_there_are_no_windows(streams: list[LabelledStream]) -> None:
    assert windows_of(streams, DURATIONS_S, 10, rng()) == []


def test_who_moves_enough_is_looked_at() -> None:
    assert len(windows_of([standing(30.0, LEAST_SPEED_M_S / 100)], DURATIONS_S, 10, rng())) > 0


@pytest.mark.thorough
def test_the_shipped_background_is_what_is_made() -> None:
    """Where this fails on purpose, `make background` makes it anew."""
    for stored, stream in zip(shipped(), made(), strict=True):
        np.testing.assert_allclose(stored.postures, stream.postures[::2], atol=0.002)
        np.testing.assert_allclose(stored.velocities, stream.velocities[::2], atol=0.002)
