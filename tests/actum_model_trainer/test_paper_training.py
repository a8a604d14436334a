"""The paper's layers learn, and are made of what they should be."""

from dataclasses import replace

import numpy as np
import pytest

from actum.skeletons import PARTS
from actum_model_trainer.answering import encoded
from actum_model_trainer.median_distances import median_neighbour_distance2
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from performers import TINY_PAPER
from som_classifier.attention import PostureInput
from som_classifier.paper_model import PaperModel
from som_classifier.presets import PaperPreset


def trained(samples: list[SegmentSample], preset: PaperPreset = TINY_PAPER) -> PaperModel:
    model = train(samples, preset)
    assert isinstance(model, PaperModel)
    return model


def test_the_description_says_what_it_was_made_of(samples: list[SegmentSample]) -> None:
    about = trained(samples).metadata.model_dump()
    assert (about["kind"], about["axes"], about["origin"], about["attention"]) == ("paper", "upright", "hips", "moving")
    assert about["parameters"]["layer1"]["steps"] == TINY_PAPER.layer1.steps


def test_vectors_are_as_long_as_the_longest_training_trace(samples: list[SegmentSample]) -> None:
    model = trained(samples)
    walked = [len(model.trace(encoded(model, sample))) for sample in samples]
    assert model.metadata.points == max(walked)


def test_a_person_who_never_moves_can_be_learned(samples: list[SegmentSample]) -> None:
    """Every trace is a single point."""
    frozen = ("joints", "postures", "velocities")
    still = [
        replace(
            sample,
            stamps_ns=sample.stamps_ns[:5],
            motion=np.zeros((5, 5)),
            **{name: np.repeat(getattr(sample, name)[-1:], 5, axis=0) for name in frozen},
        )
        for sample in samples
    ]
    model = trained(still)
    assert model.metadata.points == 2
    assert all(len(model.trace(encoded(model, sample))) == 1 for sample in still)


def test_only_the_attended_part_is_learned(samples: list[SegmentSample]) -> None:
    right_arm = replace(TINY_PAPER, posture=PostureInput("upright", "torso", "right_arm"))
    elsewhere = [joint for part in ("left_arm", "left_leg", "right_leg") for joint in PARTS[part]]
    altered = []
    for sample in samples:
        postures = sample.postures.copy()
        postures[:, elsewhere] += 0.3
        altered.append(replace(sample, postures=postures))
    models = [trained(each, right_arm) for each in (samples, altered)]
    assert (models[0].layer1.weights == models[1].layer1.weights).all()
    assert (models[0].layer3.weights == models[1].layer3.weights).all()
    assert models[0].metadata.attention == "right_arm"


def test_median_neighbour_distance_of_many_is_that_of_all_pairs() -> None:
    vectors = np.random.default_rng(0).random((200, 4))
    distances2 = ((vectors[:, None] - vectors) ** 2).sum(axis=2) + np.diag(np.full(200, np.inf))
    assert median_neighbour_distance2(vectors) == pytest.approx(np.median(distances2.min(axis=1)))


def test_median_neighbour_distance_of_equals_is_one_grid_step() -> None:
    assert median_neighbour_distance2(np.ones((4, 6))) == 1.0
