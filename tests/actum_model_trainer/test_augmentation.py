"""A sample seen from other sides keeps its shape; one of another build keeps its directions."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.geometry import BONES
from actum.skeletons import INDEX, JOINTS
from actum_model_trainer.augmentation import View, leant, rebuilt, turned, views
from actum_model_trainer.samples import SegmentSample
from performers import TINY
from recognisers import tiny_samples
from som_classifier.handedness import mirrored
from som_classifier.presets import BodyVariation

PARENTS, CHILDREN = (np.array([bone[end] for bone in BONES]) for end in (0, 1))
BONE_NAMES = sorted({JOINTS[child].removeprefix("left_").removeprefix("right_") for child in CHILDREN})
RIGHT_HANDED, LEFT_HANDED = tiny_samples()[0], tiny_samples()[2]
TORSO = INDEX["torso"]


def shown(sample: SegmentSample, seed: int = 0, mirrors: bool = True, **changes: object) -> list[View]:
    return list(views(sample, replace(TINY, **changes), mirrors, np.random.default_rng(seed)))


def others(count: int, tempo: float = 1.0) -> BodyVariation:
    return BodyVariation(count, build_sd=0.1, tempo=tempo)


def bones(postures: np.ndarray) -> np.ndarray:
    return np.asarray(postures[..., CHILDREN, :] - postures[..., PARENTS, :])


def lengths(postures: np.ndarray) -> np.ndarray:
    return np.linalg.norm(bones(postures), axis=-1)


def without(sample: SegmentSample, *names: str) -> SegmentSample:
    gone = np.isin(np.arange(15), [INDEX[name] for name in names])[:, None]
    hidden = {name: np.where(gone, np.nan, getattr(sample, name)) for name in ("postures", "velocities")}
    return replace(sample, **hidden)


def test_there_is_the_sample_itself_and_one_view_of_each_turn_and_build() -> None:
    found = shown(RIGHT_HANDED, turns_deg=(-20.0, 10.0, 20.0), leans_deg=(0.0, 5.0, 0.0), others=others(4))
    assert len(found) == 1 + 3 + 4
    np.testing.assert_array_equal(found[0].postures, RIGHT_HANDED.postures)
    np.testing.assert_array_equal(found[0].velocities, RIGHT_HANDED.velocities)
    assert {view.postures.shape for view in found} == {RIGHT_HANDED.postures.shape}
    assert len(shown(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(0))) == 1


def test_left_handed_samples_are_shown_in_a_mirror() -> None:
    itself, *others = shown(LEFT_HANDED)
    np.testing.assert_array_equal(itself.postures, mirrored(LEFT_HANDED.postures))
    np.testing.assert_array_equal(itself.velocities, mirrored(LEFT_HANDED.velocities))
    image = replace(LEFT_HANDED, postures=itself.postures, velocities=itself.velocities)
    for view, same in zip(others, shown(image)[1:], strict=True):
        np.testing.assert_array_equal(view.postures, same.postures)
    np.testing.assert_array_equal(shown(LEFT_HANDED, mirrors=False)[0].postures, LEFT_HANDED.postures)


@settings(deadline=None)
@given(st.floats(-180, 180))
def test_a_turn_keeps_every_length_and_the_vertical(degrees: float) -> None:
    _, view = shown(RIGHT_HANDED, turns_deg=(degrees,), leans_deg=(10.0,), others=others(0))
    for seen, original in ((view.postures, RIGHT_HANDED.postures), (view.velocities, RIGHT_HANDED.velocities)):
        np.testing.assert_allclose(seen[..., 1], original[..., 1], atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(seen, axis=-1), np.linalg.norm(original, axis=-1), atol=1e-12)
    np.testing.assert_allclose(lengths(view.postures), lengths(RIGHT_HANDED.postures), atol=1e-12)


@settings(deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3))
def test_turns_add_up(one: float, other: float) -> None:
    np.testing.assert_allclose(turned(one) @ turned(other), turned(one + other), atol=1e-12)
    np.testing.assert_allclose(turned(one) @ turned(-one), np.eye(3), atol=1e-12)
    assert np.linalg.det(turned(one)) == pytest.approx(1.0)


@settings(deadline=None)
@given(st.floats(-180, 180))
def test_where_depth_is_inferred_a_turned_sample_leans_too(degrees: float) -> None:
    """A lean keeps every length and the line from left to right, and tilts what is up back."""
    inferred = replace(RIGHT_HANDED, depth_inferred=True)
    _, view = shown(inferred, turns_deg=(0.0,), leans_deg=(degrees,), others=others(0))
    np.testing.assert_allclose(view.postures[..., 0], RIGHT_HANDED.postures[..., 0], atol=1e-12)
    np.testing.assert_allclose(lengths(view.postures), lengths(RIGHT_HANDED.postures), atol=1e-12)
    up = np.array([0.0, 1.0, 0.0]) @ leant(np.radians(degrees))
    np.testing.assert_allclose(up, [0.0, np.cos(np.radians(degrees)), -np.sin(np.radians(degrees))], atol=1e-12)
    both = shown(inferred, turns_deg=(15.0,), leans_deg=(degrees,), others=others(0))[1]
    np.testing.assert_allclose(
        both.velocities, RIGHT_HANDED.velocities @ turned(np.radians(15.0)) @ leant(np.radians(degrees)), atol=1e-12
    )


def test_a_quarter_turn_brings_left_to_a_side_of_forward() -> None:
    left, forward = np.eye(3)[[0, 2]]
    np.testing.assert_allclose(left @ turned(np.pi / 2), -forward, atol=1e-12)
    np.testing.assert_allclose(forward @ turned(np.pi / 2), left, atol=1e-12)


@settings(deadline=None)
@given(st.lists(st.floats(0.5, 2.0), min_size=len(BONE_NAMES), max_size=len(BONE_NAMES)))
def test_a_build_keeps_every_bones_direction_and_makes_it_longer_by_its_factor(factors: list[float]) -> None:
    by_name = dict(zip(BONE_NAMES, factors, strict=True))
    per_bone = np.array([by_name[JOINTS[c].removeprefix("left_").removeprefix("right_")] for c in CHILDREN])
    posture = RIGHT_HANDED.postures[7]
    other = rebuilt(by_name) @ posture
    np.testing.assert_allclose(other[TORSO], 0, atol=1e-12)
    np.testing.assert_allclose(bones(other), per_bone[:, None] * bones(posture), atol=1e-12)


def test_a_build_of_ones_is_the_same_person() -> None:
    np.testing.assert_allclose(
        rebuilt(dict.fromkeys(BONE_NAMES, 1.0)) @ RIGHT_HANDED.postures, RIGHT_HANDED.postures, atol=1e-12
    )


def test_builds_differ_as_much_as_they_should_and_are_alike_on_both_sides() -> None:
    _, *built = shown(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(400))
    factors = np.array([lengths(view.postures[0]) for view in built]) / lengths(RIGHT_HANDED.postures[0])
    assert np.log(factors).std(axis=0) == pytest.approx(np.full(len(CHILDREN), 0.1), rel=0.15)
    for joint in BONE_NAMES:
        sides = [i for i, child in enumerate(CHILDREN) if JOINTS[child].endswith(f"_{joint}")]
        if sides:
            np.testing.assert_allclose(factors[:, sides[0]], factors[:, sides[1]])


def test_postures_and_velocities_are_built_alike() -> None:
    sample = replace(RIGHT_HANDED, velocities=2.0 * RIGHT_HANDED.postures)
    for view in shown(sample):
        np.testing.assert_allclose(view.velocities, 2.0 * view.postures, atol=1e-12)


def test_other_people_move_as_fast_as_they_should_along_the_same_way() -> None:
    slower, alike = (
        shown(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(2, tempo))[1:] for tempo in (0.5, 1.0)
    )
    for slow, quick in zip(slower, alike, strict=True):
        np.testing.assert_array_equal(slow.postures, quick.postures)
        np.testing.assert_array_equal(slow.velocities, 0.5 * quick.velocities)


def test_builds_come_from_the_generator_alone() -> None:
    first, second, other = (shown(RIGHT_HANDED, seed)[-1].postures for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, second)
    assert (first != other).any()


@pytest.mark.parametrize("names", [["left_elbow", "left_hand"], ["right_foot"], ["head", "left_hand"]])
def test_missing_joints_stay_missing_and_no_other_is_moved_by_it(names: list[str]) -> None:
    gone = np.isin(JOINTS, names)
    for view, whole in zip(shown(without(RIGHT_HANDED, *names)), shown(RIGHT_HANDED), strict=True):
        for seen, expected in ((view.postures, whole.postures), (view.velocities, whole.velocities)):
            assert np.isnan(seen[:, gone]).all()
            np.testing.assert_allclose(seen[:, ~gone], expected[:, ~gone], atol=1e-12)
