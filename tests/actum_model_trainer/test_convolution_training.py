"""Features of random convolutions are divided by their spread in training."""

import numpy as np

from actum_model_trainer.convolution_training import Convolved
from som_classifier.convolutions import resampled
from unmarked import taught


def test_a_feature_that_is_the_same_in_all_sequences_is_left_as_it_is() -> None:
    sample = taught().usable[0]
    same = [resampled(sample.stamps_ns, sample.postures)] * 7
    convolved = Convolved.of(same, [], 4, np.random.default_rng(0))
    assert set(convolved.spread.tolist()) == {1.0}
    assert convolved.taught.max() <= 1
