"""Attention goes where the movement is, and nowhere else."""

import numpy as np
import pytest

from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES
from people import STANDING, lacking
from som_classifier.attention import ALL, ATTENTIONS, MOVING, PART_NAMES, PostureInput, attended_part


@pytest.mark.parametrize("part", range(5))
def test_the_part_that_moves_most_over_all_frames_is_attended(part: int) -> None:
    motion = np.full((10, 5), 0.02)
    motion[4:6, part] = 0.05
    motion[7, (part + 1) % 5] = 0.07
    assert attended_part(motion) == part


def test_ties_are_settled_by_the_listed_order() -> None:
    assert PART_NAMES[attended_part(np.zeros((4, 5)))] == "right_arm"
    assert PART_NAMES[attended_part(np.array([[0, 0, 0, 0, 0], [0, 1, 0, 1, 1]]))] == "left_arm"


def test_motion_from_before_the_segment_does_not_count() -> None:
    motion = np.array([[0, 0, 9.0, 0, 0], [0, 0.1, 0, 0, 0]])
    assert PART_NAMES[attended_part(motion)] == "left_arm"


def test_a_fixed_part_is_kept_whatever_moves() -> None:
    assert PART_NAMES[attended_part(np.array([[0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0]]), "left_leg")] == "left_leg"


def shown(attention: str, origin: str = "torso", axes: str = "posture") -> PostureInput:
    return PostureInput(axes=axes, origin=origin, attention=attention)  # type: ignore[arg-type]


JOINTS_M = np.random.default_rng(0).random((15, 3))
EVERY_PART = np.ones(5, dtype=bool)


def test_a_part_is_its_three_joints_one_after_the_other() -> None:
    rows = shown(MOVING).rows(JOINTS_M, STANDING)
    assert rows.shape == (5, shown(MOVING).size) == (5, 9)
    right_arm = [JOINTS_M[INDEX[name]] for name in ("right_shoulder", "right_elbow", "right_hand")]
    expected = np.concatenate([joint - JOINTS_M[INDEX["torso"]] for joint in right_arm])
    assert rows[PART_NAMES.index("right_arm")].tolist() == expected.tolist()


def test_the_whole_body_is_one_choice() -> None:
    """Of which the part that moves most is told, all the same."""
    rows = shown(ALL).rows(JOINTS_M, STANDING)
    assert rows.shape == (1, shown(ALL).size) == (1, 45)
    motion = np.array([[0, 0, 0, 0, 0], [0, 0, 0, 0.2, 0.1]])
    assert shown(ALL).attended(motion, np.ones(1, dtype=bool)) == (PART_NAMES.index("left_leg"), 0)


def test_a_fixed_or_moving_part_is_its_own_choice() -> None:
    motion = np.array([[0, 0, 0, 0, 0], [0, 0, 0, 0.2, 0.1]])
    assert shown("body").attended(motion, EVERY_PART) == (4, 4)
    assert shown(MOVING).attended(motion, EVERY_PART) == (3, 3)


@pytest.mark.parametrize(("axes", "used"), [("posture", 0), ("upright", 1)])
def test_axes_name_the_joints_that_are_read(axes: str, used: int) -> None:
    given = JOINTS_M, STANDING
    relative = given[used] - given[used][INDEX["torso"]]
    assert shown(ALL, axes=axes).rows(*given).tolist() == [relative.ravel().tolist()]


def test_from_the_hips_is_from_their_middle() -> None:
    rows = shown(ALL, "hips").rows(JOINTS_M, STANDING).reshape(15, 3)
    np.testing.assert_allclose(rows[INDEX["left_hip"]], -rows[INDEX["right_hip"]], atol=1e-15)


@pytest.mark.parametrize("gone", [["left_hip"], ["right_hip"], ["left_hip", "right_hip", "neck"]])
def test_without_a_hip_it_is_as_far_below_the_torso_as_the_neck_usually_is_above_it(gone: list[str]) -> None:
    """Whatever else is missing: the torso is always there."""
    rows = shown(ALL, "hips").rows(lacking(JOINTS_M, *gone), STANDING).reshape(15, 3)
    [length_m] = [length_m for _, end, length_m in BONES if end == INDEX["neck"]]
    np.testing.assert_allclose(rows[INDEX["torso"]], [0, length_m, 0])
    assert np.isnan(rows).any(axis=1).tolist() == [name in gone for name in JOINTS]


@pytest.mark.parametrize("changed", [{"axes": "camera"}, {"origin": "head"}, {"attention": "right arm"}])
def test_what_it_does_not_know_is_named(changed: dict[str, str]) -> None:
    settings = {"axes": "upright", "origin": "hips", "attention": "all"} | changed
    ((name, value),) = changed.items()
    with pytest.raises(ValueError, match=f"{value!r} is not a valid value of {name}"):
        PostureInput(**settings)  # type: ignore[arg-type]


def test_attention_is_one_of_so_many() -> None:
    assert set(ATTENTIONS) == {"moving", "all", *PART_NAMES}
