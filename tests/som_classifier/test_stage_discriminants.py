"""How far an action is, told by the time since it began, weighs what is known of each stage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from som_classifier.stage_discriminants import NEGLIGIBLE, StageDiscriminants

FRACTIONS = (0.3, 0.55, 0.75, 1.0)
MEAN_S, SD = 1.4, 0.3
INPUTS, ACTIONS = 50, 6


def stages(log_sd: float = SD) -> StageDiscriminants:
    rng = np.random.default_rng(0)
    axes = rng.normal(size=(len(FRACTIONS), INPUTS, ACTIONS)).astype(np.float32)
    offsets = rng.normal(size=(len(FRACTIONS), ACTIONS)).astype(np.float32)
    return StageDiscriminants(axes, offsets, FRACTIONS, float(np.log(MEAN_S)), log_sd)


def seen(weights: np.ndarray) -> float:
    """The share of an action that has been seen, on average."""
    return float(np.dot(weights, FRACTIONS))


def vector() -> np.ndarray:
    return np.random.default_rng(1).random(INPUTS).astype(np.float32)


@settings(deadline=None)
@given(st.floats(0, 1e5), st.booleans())
def test_weights_are_shares(elapsed_s: float, complete: bool) -> None:
    weights = np.array(stages().weights(elapsed_s, complete))
    assert weights.shape == (len(FRACTIONS),)
    assert weights.sum() == pytest.approx(1.0)
    assert ((weights == 0) | (weights >= NEGLIGIBLE)).all()


@settings(deadline=None)
@given(st.floats(0, 1e5))
def test_a_complete_action_is_in_its_last_stage_however_long_it_took(elapsed_s: float) -> None:
    assert stages().weights(elapsed_s, True) == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize("stage", range(len(FRACTIONS)))
def test_after_a_stages_share_of_the_usual_time_it_is_the_likeliest(stage: int) -> None:
    weights = stages().weights(MEAN_S * FRACTIONS[stage], False)
    assert int(np.argmax(weights)) == stage


def test_weights_by_hand() -> None:
    """At the usual end, stage k is log(1 / f) standard deviations off: exp(-0.5 (log f / sd)²), negligible ones out."""
    likely = np.exp(-0.5 * (np.log(FRACTIONS) / SD) ** 2)
    assert (likely / likely.sum() < NEGLIGIBLE).tolist() == [True, False, False, False]
    likely[0] = 0
    np.testing.assert_allclose(stages().weights(MEAN_S, False), likely / likely.sum())


@settings(deadline=None)
@given(st.lists(st.floats(0, 60), min_size=2, max_size=2), st.floats(0.1, 2.0))
def test_the_longer_it_lasts_the_more_has_been_seen(elapsed_s: list[float], log_sd: float) -> None:
    earlier, later = (seen(np.array(stages(log_sd).weights(s, False))) for s in sorted(elapsed_s))
    assert earlier <= later + 1e-12


def test_at_first_it_is_in_its_first_stage_and_at_last_in_its_last() -> None:
    assert stages().weights(0.0, False) == [1.0, 0.0, 0.0, 0.0]
    assert stages().weights(60.0, False) == [0.0, 0.0, 0.0, 1.0]


def test_scores_are_a_stages_products_and_offsets() -> None:
    found = stages().scores(vector(), [0.0, 1.0, 0.0, 0.0])
    assert found.dtype == np.float32
    expected = vector().astype(np.float64) @ stages().axes[1] + stages().offsets[1]
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-5)


@settings(deadline=None)
@given(st.lists(st.floats(0, 1), min_size=4, max_size=4))
def test_scores_are_linear_in_the_weights(weights: list[float]) -> None:
    each = [stages().scores(vector(), row) for row in np.eye(4).tolist()]
    np.testing.assert_allclose(stages().scores(vector(), weights), np.dot(weights, each), rtol=1e-4, atol=1e-4)


def test_a_stage_without_weight_leaves_no_trace() -> None:
    """To the bit, whatever its axes are."""
    one = stages()
    axes, offsets = one.axes.copy(), one.offsets.copy()
    axes[:3], offsets[:3] = np.inf, np.nan
    odd = StageDiscriminants(axes, offsets, FRACTIONS, one.log_duration_mean, one.log_duration_sd)
    weights = one.weights(1.0, True)
    np.testing.assert_array_equal(odd.scores(vector(), weights), one.scores(vector(), weights))
