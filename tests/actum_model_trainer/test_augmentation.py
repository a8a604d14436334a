"""A rotated sample keeps its shape; one of other proportions keeps the directions of its bones."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES
from actum_model_trainer.augmentation import Variant, bone_scaling, pitch_rotation, variants, yaw_rotation
from actum_model_trainer.samples import SegmentSample
from performers import TINY
from recognisers import tiny_samples
from som_classifier.handedness import mirrored
from som_classifier.presets import BodyVariation

PARENTS, CHILDREN = (np.array([bone[end] for bone in BONES]) for end in (0, 1))
BONE_NAMES = sorted({JOINTS[child].removeprefix("left_").removeprefix("right_") for child in CHILDREN})
RIGHT_HANDED, LEFT_HANDED = tiny_samples()[0], tiny_samples()[2]
TORSO = INDEX["torso"]


def variants_of(sample: SegmentSample, seed: int = 0, mirrors: bool = True, **changes: object) -> list[Variant]:
    return list(variants(sample, replace(TINY, **changes), mirrors, np.random.default_rng(seed)))


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


def test_there_is_the_sample_itself_and_one_variant_of_each_rotation_and_body() -> None:
    found = variants_of(RIGHT_HANDED, turns_deg=(-20.0, 10.0, 20.0), leans_deg=(0.0, 5.0, 0.0), others=others(4))
    assert len(found) == 1 + 3 + 4
    np.testing.assert_array_equal(found[0].postures, RIGHT_HANDED.postures)
    np.testing.assert_array_equal(found[0].velocities, RIGHT_HANDED.velocities)
    assert {variant.postures.shape for variant in found} == {RIGHT_HANDED.postures.shape}
    assert len(variants_of(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(0))) == 1


def test_left_handed_samples_are_mirrored() -> None:
    itself, *others = variants_of(LEFT_HANDED)
    np.testing.assert_array_equal(itself.postures, mirrored(LEFT_HANDED.postures))
    np.testing.assert_array_equal(itself.velocities, mirrored(LEFT_HANDED.velocities))
    image = replace(LEFT_HANDED, postures=itself.postures, velocities=itself.velocities)
    for variant, same in zip(others, variants_of(image)[1:], strict=True):
        np.testing.assert_array_equal(variant.postures, same.postures)
    np.testing.assert_array_equal(variants_of(LEFT_HANDED, mirrors=False)[0].postures, LEFT_HANDED.postures)


@settings(deadline=None)
@given(st.floats(-180, 180))
def test_a_yaw_rotation_keeps_every_length_and_the_vertical(degrees: float) -> None:
    _, variant = variants_of(RIGHT_HANDED, turns_deg=(degrees,), leans_deg=(10.0,), others=others(0))
    for seen, original in ((variant.postures, RIGHT_HANDED.postures), (variant.velocities, RIGHT_HANDED.velocities)):
        np.testing.assert_allclose(seen[..., 1], original[..., 1], atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(seen, axis=-1), np.linalg.norm(original, axis=-1), atol=1e-12)
    np.testing.assert_allclose(lengths(variant.postures), lengths(RIGHT_HANDED.postures), atol=1e-12)


@settings(deadline=None)
@given(st.floats(-180, 180))
def test_where_depth_is_inferred_a_rotated_sample_is_pitched_too(degrees: float) -> None:
    """A pitch keeps every length and the line from left to right, and tilts what is up back."""
    inferred = replace(RIGHT_HANDED, depth_inferred=True)
    _, variant = variants_of(inferred, turns_deg=(0.0,), leans_deg=(degrees,), others=others(0))
    np.testing.assert_allclose(variant.postures[..., 0], RIGHT_HANDED.postures[..., 0], atol=1e-12)
    np.testing.assert_allclose(lengths(variant.postures), lengths(RIGHT_HANDED.postures), atol=1e-12)
    up = np.array([0.0, 1.0, 0.0]) @ pitch_rotation(np.radians(degrees))
    np.testing.assert_allclose(up, [0.0, np.cos(np.radians(degrees)), -np.sin(np.radians(degrees))], atol=1e-12)
    both = variants_of(inferred, turns_deg=(15.0,), leans_deg=(degrees,), others=others(0))[1]
    np.testing.assert_allclose(
        both.velocities,
        RIGHT_HANDED.velocities @ yaw_rotation(np.radians(15.0)) @ pitch_rotation(np.radians(degrees)),
        atol=1e-12,
    )


def test_a_yaw_of_a_quarter_turn_brings_left_to_a_side_of_forward() -> None:
    left, forward = np.eye(3)[[0, 2]]
    np.testing.assert_allclose(left @ yaw_rotation(np.pi / 2), -forward, atol=1e-12)
    np.testing.assert_allclose(forward @ yaw_rotation(np.pi / 2), left, atol=1e-12)


@settings(deadline=None)
@given(st.lists(st.floats(0.5, 2.0), min_size=len(BONE_NAMES), max_size=len(BONE_NAMES)))
def test_bone_scaling_keeps_every_bones_direction_and_makes_it_longer_by_its_factor(factors: list[float]) -> None:
    by_name = dict(zip(BONE_NAMES, factors, strict=True))
    per_bone = np.array([by_name[JOINTS[c].removeprefix("left_").removeprefix("right_")] for c in CHILDREN])
    posture = RIGHT_HANDED.postures[7]
    other = bone_scaling(by_name) @ posture
    np.testing.assert_allclose(other[TORSO], 0, atol=1e-12)
    np.testing.assert_allclose(bones(other), per_bone[:, None] * bones(posture), atol=1e-12)


def test_proportions_differ_as_much_as_they_should_and_are_alike_on_both_sides() -> None:
    _, *scaled = variants_of(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(400))
    factors = np.array([lengths(variant.postures[0]) for variant in scaled]) / lengths(RIGHT_HANDED.postures[0])
    assert np.log(factors).std(axis=0) == pytest.approx(np.full(len(CHILDREN), 0.1), rel=0.15)
    for joint in BONE_NAMES:
        sides = [i for i, child in enumerate(CHILDREN) if JOINTS[child].endswith(f"_{joint}")]
        if sides:
            np.testing.assert_allclose(factors[:, sides[0]], factors[:, sides[1]])


def test_postures_and_velocities_are_scaled_alike() -> None:
    sample = replace(RIGHT_HANDED, velocities=2.0 * RIGHT_HANDED.postures)
    for variant in variants_of(sample):
        np.testing.assert_allclose(variant.velocities, 2.0 * variant.postures, atol=1e-12)


def test_other_people_move_as_fast_as_they_should_along_the_same_way() -> None:
    slower, alike = (
        variants_of(RIGHT_HANDED, turns_deg=(), leans_deg=(), others=others(2, tempo))[1:] for tempo in (0.5, 1.0)
    )
    for slow, quick in zip(slower, alike, strict=True):
        np.testing.assert_array_equal(slow.postures, quick.postures)
        np.testing.assert_array_equal(slow.velocities, 0.5 * quick.velocities)


def test_proportions_come_from_the_generator_alone() -> None:
    first, second, other = (variants_of(RIGHT_HANDED, seed)[-1].postures for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, second)
    assert (first != other).any()


@pytest.mark.parametrize("names", [["left_elbow", "left_hand"], ["right_foot"], ["head", "left_hand"]])
def test_missing_joints_stay_missing_and_no_other_is_moved_by_it(names: list[str]) -> None:
    gone = np.isin(JOINTS, names)
    for variant, whole in zip(variants_of(without(RIGHT_HANDED, *names)), variants_of(RIGHT_HANDED), strict=True):
        for seen, expected in ((variant.postures, whole.postures), (variant.velocities, whole.velocities)):
            assert np.isnan(seen[:, gone]).all()
            np.testing.assert_allclose(seen[:, ~gone], expected[:, ~gone], atol=1e-12)
