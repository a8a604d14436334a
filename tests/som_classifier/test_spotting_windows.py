"""The windows that end now: by stamps alone, never across a gap, never of too few frames."""

from collections.abc import Iterable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.kinematics import GAP_NS
from som_classifier.spotting.pyramid_spotter import FEWEST_FRAMES, RecentFrames

MS = SECOND_NS // 1000
DURATIONS_S = (0.5, 1.0, 2.0)
MEMORY_NS = 3 * SECOND_NS


def frame(stamp_ms: int) -> Frame:
    return Frame(stamp_ms * MS, None, (1,), 0, 2.0, np.zeros((15, 3)), np.zeros(5))


def after(stamps_ms: Iterable[int], durations_s: Sequence[float] = DURATIONS_S) -> RecentFrames:
    recent = RecentFrames(durations_s, MEMORY_NS)
    for stamp_ms in stamps_ms:
        recent.add(frame(stamp_ms))
    return recent


def windows_of(recent: RecentFrames) -> list[list[Frame]]:
    frames, firsts = recent.windows()
    return [frames[first:] for first in firsts]


def windows_ms(stamps_ms: Iterable[int], durations_s: Sequence[float] = DURATIONS_S) -> list[tuple[int, int, int]]:
    """First and last stamp (ms) and number of frames of each window."""
    windows = windows_of(after(stamps_ms, durations_s))
    return [(each[0].stamp_ns // MS, each[-1].stamp_ns // MS, len(each)) for each in windows]


def test_there_is_one_of_each_duration_the_shortest_first_and_all_end_with_the_newest_frame() -> None:
    assert windows_ms(range(0, 3001, 100)) == [(2500, 3000, 6), (2000, 3000, 11), (1000, 3000, 21)]


@pytest.mark.parametrize(("last_ms", "longest"), [(300, 0), (400, 1), (700, 1), (800, 2), (1500, 2), (1600, 3)])
def test_a_window_is_looked_at_once_frames_cover_four_fifths_of_its_duration(last_ms: int, longest: int) -> None:
    assert len(windows_ms(range(0, last_ms + 1, 100))) == longest


def test_a_window_of_fewer_frames_than_the_pyramid_needs_is_left_out() -> None:
    assert windows_ms([0, 250, 500], (0.5,)) == []
    assert windows_ms([0, 200, 300, 500], (0.5,)) == [(0, 500, FEWEST_FRAMES)]


def test_lost_frames_alone_change_no_bounds() -> None:
    assert windows_ms([0, 100, 400, 500, 900, 1000], (1.0,)) == [(0, 1000, 6)]


def test_no_window_reaches_back_over_a_gap() -> None:
    begun = range(0, 1001, 100)
    gap_ms = GAP_NS // MS
    assert windows_ms([*begun, *range(1000 + gap_ms, 2501, 100)], (2.0,)) == [(500, 2500, 17)]
    assert windows_ms([*begun, *range(1001 + gap_ms, 2501, 100)], (2.0,)) == []
    assert windows_ms([*begun, *range(1001 + gap_ms, 2501, 100)], (1.0,)) == [(1501, 2401, 10)]


def test_a_frame_says_whether_it_follows_without_a_gap() -> None:
    recent = RecentFrames(DURATIONS_S, MEMORY_NS)
    stamps_ms = [0, 100, 600, 1101, 1200, 700, 800]
    assert [recent.add(frame(ms)) for ms in stamps_ms] == [False, True, True, False, True, False, True]


def test_the_frames_between_two_stamps_include_both() -> None:
    recent = after(range(0, 1001, 100))
    assert [each.stamp_ns // MS for each in recent.between(300 * MS, 500 * MS)] == [300, 400, 500]
    assert recent.between(2000 * MS, 3000 * MS) == []


def test_frames_are_kept_no_longer_than_asked_for() -> None:
    recent = after(range(0, 3_600_000, 100))
    assert len(recent.between(0, 3600 * SECOND_NS)) == 1 + MEMORY_NS // (100 * MS)


@given(steps_ms=st.lists(st.integers(1, 700), min_size=1, max_size=60))
def test_every_window_holds_all_frames_from_its_first_to_the_newest_and_no_gap(steps_ms: list[int]) -> None:
    stamps_ms = np.cumsum(steps_ms).tolist()
    for window, duration_s in zip(*_with_durations(after(stamps_ms)), strict=True):
        stamps_ns = [each.stamp_ns for each in window]
        assert stamps_ns == [ms * MS for ms in stamps_ms][-len(window) :]
        assert max(np.diff(stamps_ns)) <= GAP_NS
        assert 0.8 * duration_s * SECOND_NS <= stamps_ns[-1] - stamps_ns[0] <= duration_s * SECOND_NS
        assert len(window) >= FEWEST_FRAMES


def _with_durations(recent: RecentFrames) -> tuple[list[list[Frame]], list[float]]:
    """The windows, and the duration of each: no window may stand for two of these."""
    windows = windows_of(recent)
    lasting_s = [(each[-1].stamp_ns - each[0].stamp_ns) / SECOND_NS for each in windows]
    return windows, [min(d for d in DURATIONS_S if d >= lasted_s) for lasted_s in lasting_s]
