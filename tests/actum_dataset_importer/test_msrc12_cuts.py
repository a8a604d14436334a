"""A repetition of MSRC-12 reaches from where the actor begins to move to where they have stopped."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from actum.recorder import Recorder
from actum.recording import Recording
from actum_dataset_importer.msrc12 import stored_stream
from actum_dataset_importer.msrc12_cuts import Cut, cuts_of, resting_pose, trimmed
from actum_dataset_importer.takes import Take
from msrc12_streams import LIFT_S, PERIOD_S, lifting, written

NAME = "P3_1_1_p01"
S = 1_000_000_000


def cuts(folder: Path, **parts: np.ndarray) -> list[Cut | None]:
    stream = stored_stream(written(folder, {NAME: lifting(4) | parts}), NAME)
    return cuts_of(stream, resting_pose([stream]))


def read(path: Path) -> Take:
    (take,) = trimmed(path, [NAME], "door")
    return take


def starts_and_ends_s(take: Take) -> list[tuple[float, float]]:
    times_s = [(mark.stamp_ns or 0) / S for mark in take.marks]
    return list(zip(times_s[::2], times_s[1::2], strict=True))


def test_marks_hold_the_movement_and_not_the_rest(tmp_path: Path) -> None:
    take = read(written(tmp_path, {NAME: lifting(4)}))
    assert [mark.label for mark in take.marks[::2]] == ["lift arms"] * 4
    for number, (start_s, end_s) in enumerate(starts_and_ends_s(take)):
        middle_s = (number + 0.5) * PERIOD_S
        assert start_s == pytest.approx(middle_s - LIFT_S / 2, abs=0.3)
        assert end_s == pytest.approx(middle_s + LIFT_S / 2, abs=0.3)


def test_action_points_stay_with_their_segments(tmp_path: Path) -> None:
    take = read(written(tmp_path, {NAME: lifting(3)}))
    with Recorder(tmp_path / "x.mcap", person="1", source="msrc12", **take.metadata) as recorder:
        recorder.write(take.frames[0])
    points_ns = Recording(tmp_path / "x.mcap").action_points_ns
    assert points_ns == {f"{NAME}-{number:02d}": (4 * number - 2) * S for number in (1, 2, 3)}


def test_repetitions_follow_each_other_without_overlap(tmp_path: Path) -> None:
    found = [cut for cut in cuts(tmp_path) if cut]
    assert len(found) == 4
    for cut in found:
        assert cut.first <= cut.start < cut.end <= cut.last
    assert all(before.last == after.first for before, after in pairwise(found))


def test_drifting_sideways_is_no_movement(tmp_path: Path) -> None:
    drifting, standing = cuts(tmp_path, **lifting(4, drift_m_s=0.1)), cuts(tmp_path)
    assert [cut and (cut.start, cut.end) for cut in drifting] == [cut and (cut.start, cut.end) for cut in standing]


def test_where_nobody_is_seen_nothing_is_marked(tmp_path: Path) -> None:
    nobody = np.zeros_like(lifting(4)["xyz_mm"])
    assert cuts(tmp_path, xyz_mm=nobody) == [None] * 4
    partly = lifting(4)["xyz_mm"]
    partly[: round(2 * PERIOD_S * 30)] = 0
    first, _, third, fourth = cuts(tmp_path, xyz_mm=partly)
    assert first is None
    assert third and fourth
    take = read(written(tmp_path, {NAME: lifting(4) | {"xyz_mm": partly}}))
    assert f"{NAME}-01" in take.skipped
    assert f"{NAME}-01" not in take.metadata["action_points_ns"]


def test_somebody_who_never_moves_is_cut_without_an_error(tmp_path: Path) -> None:
    still = np.repeat(lifting(4)["xyz_mm"][:1], 480, axis=0)
    assert len(cuts(tmp_path, xyz_mm=still)) == 4


def test_a_single_point_and_none_are_cut(tmp_path: Path) -> None:
    (cut,) = cuts(tmp_path, tags_us=lifting(4)["tags_us"][1:2])
    assert cut is not None
    assert cuts(tmp_path, tags_us=np.array([], dtype=np.int64)) == []
