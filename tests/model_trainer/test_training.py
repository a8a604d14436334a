"""A training depends on its samples, preset and seed alone, and learns."""

from dataclasses import replace

import numpy as np
import pytest

from actum.recording import Recording
from actum.skeletons import PARTS
from model_trainer.samples import SegmentSample, samples_from
from model_trainer.training import TrainingError, digest_of, train, typical_distance2
from performers import HAND_PATHS, TINY
from som_classifier.model import Model
from som_classifier.trace import without_repeats


@pytest.fixture
def samples(three_people: list[Recording]) -> list[SegmentSample]:
    return samples_from(three_people).usable


def cells_of(model: Model, sample: SegmentSample) -> np.ndarray:
    return np.stack([model.cells(joints) for joints in sample.joints])


def answer(model: Model, sample: SegmentSample) -> str:
    return model.recognise(cells_of(model, sample), sample.motion).label


def test_every_training_sample_is_learned(samples: list[SegmentSample]) -> None:
    model = train(samples, TINY)
    assert [answer(model, sample) for sample in samples] == [sample.label for sample in samples]


def test_a_person_not_trained_on_is_recognised(samples: list[SegmentSample]) -> None:
    model = train([sample for sample in samples if sample.person != "2"], TINY)
    unseen = [sample for sample in samples if sample.person == "2"]
    assert [answer(model, sample) for sample in unseen] == [sample.label for sample in unseen]


def test_the_same_seed_makes_the_same_model(samples: list[SegmentSample]) -> None:
    first, second, other = (train(samples, TINY, seed).id for seed in (0, 0, 1))
    assert first == second != other


def test_the_description_says_what_it_was_made_of(samples: list[SegmentSample]) -> None:
    about = train(samples, TINY, seed=5).metadata
    assert about["labels"] == sorted(HAND_PATHS)
    assert about["persons"] == ["1", "2", "3"]
    assert (about["preset"], about["seed"], about["samples"], about["part"]) == ("tiny", 5, len(samples), None)
    assert about["parameters"]["layer1"]["steps"] == TINY.layer1.steps
    assert about["data_digest"] == digest_of(samples)


def test_the_digest_tells_samples_apart(samples: list[SegmentSample]) -> None:
    changed = [replace(samples[0], label="other"), *samples[1:]]
    moved = [replace(samples[0], joints=samples[0].joints + 1e-9), *samples[1:]]
    assert len({digest_of(s) for s in (samples, changed, moved, samples[::-1], samples[1:])}) == 5


def test_vectors_are_as_long_as_the_longest_training_trace(samples: list[SegmentSample]) -> None:
    model = train(samples, TINY)
    walked = [len(model.recognise(cells_of(model, sample), sample.motion).trace) for sample in samples]
    assert model.description.points == max(walked)


def test_a_person_who_never_moves_can_be_learned(samples: list[SegmentSample]) -> None:
    """Every trace is a single point."""
    still = [replace(s, joints=np.repeat(s.joints[-1:], 5, axis=0), motion=np.zeros((5, 5))) for s in samples]
    model = train(still, TINY)
    assert model.description.points == 2
    assert all(len(without_repeats(cells_of(model, sample)[:, 0])) == 1 for sample in still)


def test_only_the_attended_part_is_learned(samples: list[SegmentSample]) -> None:
    right_arm = replace(TINY, part="right_arm")
    elsewhere = [joint for part, joints in PARTS.items() if part != "right_arm" for joint in joints]
    altered = []
    for sample in samples:
        joints = sample.joints.copy()
        joints[:, elsewhere] += 0.3
        altered.append(replace(sample, joints=joints))
    models = [train(each, right_arm) for each in (samples, altered)]
    assert (models[0].layer1.weights == models[1].layer1.weights).all()
    assert (models[0].layer3.weights == models[1].layer3.weights).all()
    assert models[0].description.part == "right_arm"


@pytest.mark.parametrize("labels", [[], ["lift"]])
def test_fewer_than_two_actions_are_refused(samples: list[SegmentSample], labels: list[str]) -> None:
    with pytest.raises(TrainingError, match="at least two actions"):
        train([sample for sample in samples if sample.label in labels], TINY)


def test_progress_names_every_stage_to_its_end(samples: list[SegmentSample]) -> None:
    told: list[tuple[str, int, int]] = []
    train(samples, TINY, progress=lambda *done: told.append(done))
    ends = [(stage, total) for stage, done, total in told if done == total]
    assert ends == [("layer 1", TINY.layer1.steps), ("layer 2", TINY.layer2.steps), ("layer 3", TINY.epochs)]


def test_typical_distance_by_hand() -> None:
    """Nearest neighbours are 1, 1, 2 and 6 away."""
    assert typical_distance2(np.array([[0.0], [1.0], [3.0], [9.0]])) == (1 + 4) / 2


def test_typical_distance_of_many_is_that_of_all_pairs() -> None:
    vectors = np.random.default_rng(0).random((200, 4))
    distances2 = ((vectors[:, None] - vectors) ** 2).sum(axis=2) + np.diag(np.full(200, np.inf))
    assert typical_distance2(vectors) == pytest.approx(np.median(distances2.min(axis=1)))


def test_typical_distance_of_equals_is_one_grid_step() -> None:
    assert typical_distance2(np.ones((4, 6))) == 1.0
