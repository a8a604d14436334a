"""Left-handed is who moves the left arm most, and clearly more than the right."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.skeletons import INDEX, JOINTS
from people import STANDING
from som_classifier.handedness import LimbSpreads, acting_hands, left_handed, limb_moments, mirrored

LIMBS = ("right arm", "left arm", "right leg", "left leg")
ENDS = ("right_hand", "left_hand", "right_foot", "left_foot")
POSTURE = STANDING - STANDING[2]


def spreads(postures: np.ndarray) -> LimbSpreads:
    return LimbSpreads.of(np.sum([limb_moments(posture) for posture in postures], axis=0))


def swaying(**reach_m: float) -> np.ndarray:
    """A person (40, 15, 3) whose hands or feet sway up and down by so much, half each way."""
    postures = np.tile(POSTURE, (40, 1, 1))
    for name, reach in reach_m.items():
        postures[:, INDEX[name], 1] += reach / 2 * np.where(np.arange(40) % 2, 1, -1)
    return postures


def acting(seed: int = 0, frames: int = 30) -> np.ndarray:
    """In whole millimetres, which sums keep exactly."""
    return np.rint(np.random.default_rng(seed).normal(0, 300, (frames, 15, 3))) / 1000


def test_a_mirrored_person_is_the_other_way_round() -> None:
    image = mirrored(POSTURE)
    for name in JOINTS:
        side, _, rest = name.partition("_")
        other = {"left": "right_", "right": "left_"}.get(side, side) + rest
        np.testing.assert_array_equal(image[INDEX[other]], POSTURE[INDEX[name]] * [-1, 1, 1])


@given(st.integers(0, 1000))
def test_the_mirror_image_of_the_mirror_image_is_the_person(seed: int) -> None:
    postures = acting(seed, 3)
    postures[1, seed % 15] = np.nan
    np.testing.assert_array_equal(mirrored(mirrored(postures)), postures)


def test_spread_by_hand() -> None:
    """A hand that is 100 mm above its mean half the time and 100 mm below it else is 100 mm away on average."""
    assert spreads(swaying(right_hand=0.2)).limbs == [100.0, 0.0, 0.0, 0.0]
    assert spreads(swaying(left_foot=0.08)).limbs == [0.0, 0.0, 0.0, 40.0]


def test_spread_is_the_root_mean_square_distance_to_the_mean_of_elbow_and_hand() -> None:
    postures = acting()
    found = spreads(postures).limbs
    for limb, joints in enumerate(((7, 8), (4, 5), (13, 14), (10, 11))):
        about = postures[:, joints] - postures[:, joints].mean(axis=0)
        assert found[limb] == pytest.approx(1000 * np.sqrt((about**2).sum(axis=(1, 2)).mean()))


@given(st.permutations(range(12)), st.integers(0, 12))
def test_moments_add_up_to_the_same_in_any_order_and_in_parts(order: list[int], cut: int) -> None:
    each = np.array([limb_moments(posture) for posture in np.random.default_rng(0).normal(0, 0.3, (12, 15, 3))])
    assert each.dtype == np.int64
    parts = each[order[:cut]].sum(axis=0) + each[order[cut:]].sum(axis=0)
    np.testing.assert_array_equal(parts, each.sum(axis=0))


@given(st.tuples(*[st.integers(-2000, 2000)] * 3))
def test_where_the_limbs_are_does_not_matter(shift_mm: tuple[int, int, int]) -> None:
    moved = acting() + np.array(shift_mm) / 1000
    np.testing.assert_allclose(spreads(moved).limbs, spreads(acting()).limbs, rtol=1e-9)


@given(st.integers(1, 5))
def test_spread_grows_with_the_person(factor: int) -> None:
    np.testing.assert_allclose(spreads(factor * acting()).limbs, factor * np.array(spreads(acting()).limbs))


def test_a_mirrored_persons_limbs_are_exchanged() -> None:
    right_arm, left_arm, right_leg, left_leg = spreads(acting()).limbs
    assert spreads(mirrored(acting())).limbs == [left_arm, right_arm, left_leg, right_leg]


@pytest.mark.parametrize(
    ("moving", "left_handed"),
    [
        ({}, False),
        ({"left_hand": 0.4}, True),
        ({"right_hand": 0.4}, False),
        ({"left_hand": 0.4, "right_hand": 0.4}, False),
        ({"left_hand": 0.4, "right_hand": 0.3}, False),
        ({"left_hand": 0.4, "right_hand": 0.1}, True),
        ({"left_hand": 0.4, "right_foot": 0.5}, False),
        ({"left_hand": 0.4, "left_foot": 0.3}, True),
        ({"left_hand": 0.02}, False),
    ],
)
def test_left_handed_is_whose_left_arm_moves_most_and_clearly_more(moving: dict[str, float], left_handed: bool) -> None:
    assert spreads(swaying(**moving)).left_handed == left_handed


@pytest.mark.parametrize("end", range(4))
def test_a_limb_with_a_missing_joint_is_left_out_for_that_long(end: int) -> None:
    postures, missing = acting(), INDEX[ENDS[end]]
    gone = postures.copy()
    gone[10:20, missing] = np.nan
    whole, partly, without = spreads(postures).limbs, spreads(gone).limbs, np.delete(postures, range(10, 20), axis=0)
    np.testing.assert_array_equal(np.delete(partly, end), np.delete(whole, end))
    assert partly[end] == spreads(without).limbs[end] != whole[end]


def test_a_limb_that_is_never_there_does_not_move() -> None:
    postures = swaying(left_hand=0.4, right_hand=0.4)
    postures[:, INDEX["left_hand"]] = np.nan
    found = spreads(postures)
    assert found.limbs == [200.0, 0.0, 0.0, 0.0]
    assert not found.left_handed
    assert spreads(mirrored(postures)).left_handed


def test_no_frame_is_no_movement() -> None:
    assert LimbSpreads.of(np.zeros((4, 8), np.int64)).limbs == [0.0] * 4


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.02, 0.1]))
def test_of_many_spans_the_same_hands_act_as_of_each_alone(seed: int, more_m: float) -> None:
    rng = np.random.default_rng(seed)
    postures = acting(seed) * 0.1 + swaying(left_hand=more_m)[:30]
    postures[rng.random(30) < 0.2, INDEX["right_hand"]] = np.nan
    moments = limb_moments(postures)
    summed = np.concatenate([np.zeros_like(moments[:1]), np.cumsum(moments, axis=0)])
    firsts, afters = np.sort(rng.integers(0, 31, (50, 2)), axis=1).T
    spans = summed[firsts], summed[afters]
    expected = [LimbSpreads.between(*each).acting_hand for each in zip(*spans, strict=True)]
    assert acting_hands(*spans) == expected
    assert left_handed(*spans).tolist() == [hand == "left" for hand in expected]
