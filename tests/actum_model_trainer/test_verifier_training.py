"""A verifier learns from what was taught, from actions left out, and from background; its number is a probability."""

from dataclasses import replace

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.training import train
from actum_model_trainer.verifier_training import (
    STRANGE_QUANTILE,
    STRANGE_SHARE,
    Likenesses,
    least_likenesses,
    verification,
)
from performers import TINY
from recognisers import tiny_samples
from som_classifier.pyramid_model import PyramidModel

ALONE = replace(TINY.prior, people=0.0)
"""No prior: what the scores show."""
SEVERAL = 3
"""How many people."""


def likenesses(true: float, untaught: float, background: float, strange: int = 300) -> Likenesses:
    """About these means, spread by 0.1; all that was taught is rightly called."""
    rng = np.random.default_rng(0)
    taught, without, beside = (
        rng.normal(mean, 0.1, count) for mean, count in ((true, 800), (untaught, 800), (background, strange))
    )
    return Likenesses(taught, np.ones(800, dtype=bool), without, beside)


def test_the_probability_is_the_share_of_true_instances_at_a_likeness() -> None:
    """Scores of 0.5 ± 0.1 and 0.3 ± 0.1: by Bayes' rule the logit is linear, and 0 where both are as frequent."""
    slope, intercept = verification(likenesses(0.5, 0.3, 0.3), ALONE, SEVERAL)
    assert slope == pytest.approx(0.2 / 0.1**2, rel=0.15)
    even = 0.4 + 0.1**2 / 0.2 * np.log(2 * STRANGE_SHARE)
    assert -intercept / slope == pytest.approx(even, abs=0.02)


def test_without_background_actions_left_out_still_count() -> None:
    slope, intercept = verification(likenesses(0.5, 0.3, 0.3, strange=0), ALONE, SEVERAL)
    assert slope > 0 > intercept


def test_what_is_wrongly_called_is_no_true_instance() -> None:
    of = likenesses(0.5, 0.3, 0.3)
    half = replace(of, is_right=np.arange(800) < 400)
    sure, unsure = (verification(each, ALONE, SEVERAL) for each in (of, half))
    assert unsure[0] * 0.5 + unsure[1] < sure[0] * 0.5 + sure[1] - 0.5


def test_one_person_shows_nothing_of_others_so_the_prior_decides() -> None:
    of, (slope, intercept) = likenesses(0.9, 0.1, 0.1), TINY.prior.verification
    expected = slope / np.sqrt(np.quantile(of.untaught, STRANGE_QUANTILE)), intercept
    assert verification(of, TINY.prior, 1) == pytest.approx(expected)
    many = verification(of, TINY.prior, 500)
    assert many == pytest.approx(verification(of, ALONE, SEVERAL), rel=0.05)


def test_in_the_prior_a_likeness_counts_the_less_the_higher_everything_scores() -> None:
    """With more examples everything scores higher, strange movement, too."""
    few = likenesses(0.9, 0.3, 0.3)
    twice = replace(few, untaught=2 * few.untaught)
    (of_few, _), (of_twice, _) = (verification(each, TINY.prior, 1) for each in (few, twice))
    assert of_few == pytest.approx(np.sqrt(2) * of_twice)


def test_where_all_else_scores_below_0_the_prior_stays_finite() -> None:
    of = likenesses(0.9, -0.5, 0.1)
    assert np.isfinite(verification(of, TINY.prior, 1)).all()


def test_shares_of_true_instances_are_more_like_than_the_least() -> None:
    of = likenesses(0.9, 0.1, 0.1)
    known, found = least_likenesses(of, replace(TINY, prior=ALONE), SEVERAL, one_sample_each=False)
    assert (of.taught > known).mean() == pytest.approx(TINY.known_share, abs=0.01)
    assert (of.taught > found).mean() == pytest.approx(TINY.found_share, abs=0.01)


def test_the_least_of_one_person_is_the_priors() -> None:
    of = likenesses(0.9, 0.1, 0.1)
    assert least_likenesses(of, TINY, 1, one_sample_each=False) == TINY.prior.least_likeness
    assert least_likenesses(of, TINY, 1, one_sample_each=True) == TINY.prior.least_from_one


def test_those_that_are_wrongly_called_do_not_lower_the_least() -> None:
    of, alone = likenesses(0.9, 0.1, 0.1), replace(TINY, prior=ALONE)
    is_right = np.append(of.is_right, np.zeros(200, dtype=bool))
    with_wrong = replace(of, taught=np.append(of.taught, np.zeros(200)), is_right=is_right)
    assert least_likenesses(with_wrong, alone, SEVERAL, one_sample_each=False) == least_likenesses(
        of, alone, SEVERAL, one_sample_each=False
    )
    nothing_right = replace(of, is_right=np.zeros(800, dtype=bool))
    assert np.isfinite(least_likenesses(nothing_right, alone, SEVERAL, one_sample_each=False)).all()


@pytest.fixture(scope="module")
def samples() -> list[SegmentSample]:
    return tiny_samples()


def test_background_makes_what_is_like_it_less_familiar(samples: list[SegmentSample]) -> None:
    """A swing that nobody taught: with other swings as background it is less familiar, and the names stay."""
    taught = [sample for sample in samples if sample.label != "swing"]
    swings = [sample for sample in samples if sample.label == "swing"]
    streams = [stream_of(swings[:-1])]
    without, beside = (train(taught, replace(TINY, background=60), background=each) for each in ([], streams))
    assert isinstance(without, PyramidModel)
    for swing in swings[-1:]:
        bare, told = (answer(model, encoded(model, swing)) for model in (without, beside))
        assert (told.familiarity or 0) < (bare.familiarity or 0)
        assert told.label == bare.label
    assert [answer(beside, encoded(beside, s)).label for s in taught] == [s.label for s in taught]
    assert not any(answer(beside, encoded(beside, sample)).unknown for sample in taught)


def stream_of(samples: list[SegmentSample]) -> LabelledStream:
    """One sample after the other, without a label."""
    names = ("motion", "postures", "velocities")
    motion, postures, velocities = (np.concatenate([getattr(sample, name) for sample in samples]) for name in names)
    stamps_ns = np.arange(len(motion)) * SECOND_NS // 30
    return LabelledStream(stamps_ns, motion, postures, velocities, (), "somebody", "x", 1)
