"""Attention goes where the movement is, and nowhere else."""

import numpy as np
import pytest

from actum.skeletons import INDEX
from som_classifier.attention import PART_NAMES, attended, part_inputs


@pytest.mark.parametrize("part", range(5))
def test_the_part_that_moves_most_over_all_frames_is_attended(part: int) -> None:
    motion = np.full((10, 5), 0.02)
    motion[4:6, part] = 0.05
    motion[7, (part + 1) % 5] = 0.07
    assert attended(motion) == part


def test_ties_are_settled_by_the_listed_order() -> None:
    assert PART_NAMES[attended(np.zeros((4, 5)))] == "right_arm"
    assert PART_NAMES[attended(np.array([[0, 0, 0, 0, 0], [0, 1, 0, 1, 1]]))] == "left_arm"


def test_motion_from_before_the_segment_does_not_count() -> None:
    motion = np.array([[0, 0, 9.0, 0, 0], [0, 0.1, 0, 0, 0]])
    assert PART_NAMES[attended(motion)] == "left_arm"


def test_a_fixed_part_is_kept_whatever_moves() -> None:
    assert PART_NAMES[attended(np.array([[0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0]]), "left_leg")] == "left_leg"


def test_a_part_is_its_three_joints_one_after_the_other() -> None:
    joints = np.arange(45, dtype=np.float64).reshape(15, 3)
    inputs = part_inputs(joints)
    assert inputs.shape == (5, 9)
    right_arm = [joints[INDEX[name]] for name in ("right_shoulder", "right_elbow", "right_hand")]
    assert inputs[PART_NAMES.index("right_arm")].tolist() == np.concatenate(right_arm).tolist()
