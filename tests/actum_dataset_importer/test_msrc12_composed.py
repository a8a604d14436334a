"""Composed streams of MSRC-12 hold all gestures of a person in mixed order, joined smoothly, with their true times."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from actum.recording import Recording
from actum.skeletons import INDEX
from actum_dataset_importer.importing import import_msrc12_composed
from actum_dataset_importer.msrc12_composed import composed
from actum_dataset_importer.takes import DatasetError, Take
from msrc12_streams import LIFT_S, lifting, written

NAMES = [f"P3_1_{gesture}_p01" for gesture in range(1, 13)]
S = 1_000_000_000


def person(folder: Path, names: list[str] = NAMES, repetitions: int = 6) -> Path:
    return written(folder, {name: lifting(repetitions, aside_m=0.5 * k) for k, name in enumerate(names)})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return person(tmp_path_factory.mktemp("msrc12"))


@pytest.fixture(scope="module")
def both(folder: Path) -> list[Take]:
    """The two streams of the person."""
    return list(composed(folder, NAMES, "door"))


def test_each_person_has_two_streams_of_two_repetitions_of_every_gesture(both: list[Take]) -> None:
    assert [(take.name, take.person) for take in both] == [("composed_p01_1", "1"), ("composed_p01_2", "1")]
    for take in both:
        labels = [mark.label for mark in take.marks if mark.label]
        assert set(Counter(labels).values()) == {2}
        assert len(set(labels)) == 12
        assert all(before != after for before, after in pairwise(labels))
    ids = [mark.segment_id for take in both for mark in take.marks if mark.kind == "start"]
    assert len(set(ids)) == 48


def test_the_first_and_the_last_repetition_of_a_file_are_left_out(both: list[Take]) -> None:
    numbers = {mark.segment_id[-2:] for take in both for mark in take.marks}
    assert numbers == {"02", "03", "04", "05"}


def test_stamps_are_even_at_thirty_hertz(both: list[Take]) -> None:
    stamps_ns = np.array([frame.stamp_ns for frame in both[0].frames])
    assert set(np.diff(stamps_ns)) <= {33_333_333, 33_333_334}


def test_marks_hold_the_movement_and_points_its_middle(folder: Path, both: list[Take], tmp_path: Path) -> None:
    import_msrc12_composed(folder.parent, tmp_path / "out", lambda done, total: None)
    recording = Recording(tmp_path / "out" / "composed_p01_1.mcap")
    points_ns = recording.action_points_ns
    marks = both[0].marks
    for start, end in zip(marks[::2], marks[1::2], strict=True):
        assert start.stamp_ns is not None and end.stamp_ns is not None
        assert (end.stamp_ns - start.stamp_ns) / S == pytest.approx(LIFT_S, abs=0.6)
        middle_ns = (start.stamp_ns + end.stamp_ns) / 2
        assert points_ns[start.segment_id] == pytest.approx(middle_ns, abs=0.2 * S)


def test_a_person_stays_in_place_and_never_jumps(both: list[Take]) -> None:
    for take in both:
        joints = np.array([frame.agents[0].joints for frame in take.frames])
        assert np.ptp(joints[:, INDEX["torso"]], axis=0).max() < 0.001
        fastest_m = np.linalg.norm(np.diff(joints, axis=0), axis=2).max()
        assert fastest_m < 1.1 * 0.4 * 2 * np.pi / LIFT_S / 30


def test_the_same_set_makes_the_same_streams(folder: Path, both: list[Take]) -> None:
    assert list(composed(folder, NAMES, "door")) == both


def test_one_gesture_alone_cannot_be_mixed(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"p01\.npz contains too few different gestures"):
        list(composed(person(tmp_path, NAMES[:1]), NAMES[:1], "door"))


@pytest.mark.data
@pytest.mark.long
def test_the_real_set_makes_two_streams_of_each_person(data: Path, tmp_path: Path) -> None:
    report = import_msrc12_composed(data / "msrc12", tmp_path, lambda done, total: None)
    assert (report.files, report.segments, len(report.persons), len(report.actions)) == (30, 720, 15, 12)
