"""The clock of stamps: the time of day at first, and then whatever has passed."""

import time

import pytest

from actum import steady_clock


def test_it_tells_the_time_of_day() -> None:
    assert abs(steady_clock.now_ns() - time.time_ns()) < 5 * 10**9


@pytest.mark.parametrize("step_s", [-1.0, 1.0, -3600.0])
def test_it_goes_on_where_the_wall_clock_is_set(step_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    before_ns, before_s = steady_clock.now_ns(), time.monotonic()
    monkeypatch.setattr(time, "time_ns", lambda: before_ns + round(step_s * 1e9))
    passed_s = (steady_clock.now_ns() - before_ns) / 1e9
    assert 0 <= passed_s <= time.monotonic() - before_s + abs(step_s) / 2
