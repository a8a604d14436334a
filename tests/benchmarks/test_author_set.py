"""The author's screen skeletons become what MSR Action3D has of the same sequences."""

from pathlib import Path

import numpy as np
import pytest
from benchmarks.paper.details import turns_deg
from benchmarks.paper.set1 import FOCAL_PX, positions_m, read_sequence

from actum_dataset_importer import msr_action3d
from actum_dataset_importer.takes import DatasetError
from people import STANDING

pytestmark = pytest.mark.thorough

NAMES = ["a01_s01_e01", "a05_s06_e02", "a07_s08_e02"]


def test_a_point_by_hand() -> None:
    """250 units of 4 mm are a metre; the focal length to the right and below is a metre to either side."""
    np.testing.assert_allclose(
        positions_m(np.array([[160 + FOCAL_PX, 120 + FOCAL_PX, 250.0, 1.0]])), [[1.0, -1.0, 1.0]]
    )


@pytest.mark.data
@pytest.mark.parametrize("name", NAMES)
def test_a_sequence_is_that_of_msr_action3d(data: Path, name: str) -> None:
    """Within what a pixel is worth at that distance."""
    ours = read_sequence(data / "gharaee_set1" / f"{name}.txt")
    theirs = msr_action3d.read_sequence(data / "msr_action3d" / "real3d" / f"{name}_skeleton3D.txt", "kinect0")
    assert (ours.name, ours.person, ours.marks) == (theirs.name, theirs.person, theirs.marks)
    for mine, other in zip(ours.frames, theirs.frames, strict=True):
        np.testing.assert_allclose(np.array(mine.agents[0].joints), np.array(other.agents[0].joints), atol=0.012)


def test_a_foreign_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="a01_s01_e01"):
        read_sequence(tmp_path / "a99_s01_e01.txt")


def test_axes_turn_by_as_much_as_the_person() -> None:
    angle = np.radians(17.0)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    assert turns_deg(np.stack([STANDING, STANDING, STANDING @ turn.T])) == pytest.approx([0.0, 17.0], abs=1e-4)
