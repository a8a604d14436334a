"""A training of either kind depends on its samples, preset and seed alone, and learns."""

from dataclasses import replace

import numpy as np
import pytest

from actum.recording import Recording
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.provenance import TrainingError, digest_of
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from performers import HAND_PATHS, TINY, TINY_OF_EACH_KIND, TINY_PAPER
from som_classifier.first_layer import MAP_INPUTS
from som_classifier.model import Model
from som_classifier.presets import Preset

each_preset = pytest.mark.parametrize("preset", TINY_OF_EACH_KIND, ids=lambda preset: preset.name)


def labels(model: Model, samples: list[SegmentSample]) -> list[str]:
    return [answer(model, encoded(model, sample)).label for sample in samples]


@each_preset
def test_a_person_not_trained_on_is_recognised(samples: list[SegmentSample], preset: Preset) -> None:
    model = train([sample for sample in samples if sample.person != "2"], preset)
    unseen = [sample for sample in samples if sample.person == "2"]
    assert labels(model, unseen) == [sample.label for sample in unseen]


@each_preset
def test_the_same_seed_makes_the_same_model(samples: list[SegmentSample], preset: Preset) -> None:
    first, second, other = (train(samples, preset, seed) for seed in (0, 0, 1))
    assert first.id == second.id
    for name, array in first.arrays.items():
        np.testing.assert_array_equal(array, second.arrays[name])
        assert not np.array_equal(array, other.arrays[name])


@pytest.mark.parametrize("setting", ["ACTUM_REACH_LIMIT_M", "ACTUM_BONE_LIMIT_M"])
def test_the_environment_does_not_change_a_trained_model(
    three_people: list[Recording], samples: list[SegmentSample], setting: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With limits this tight the preprocessor that runs live would reject every frame."""
    monkeypatch.setenv(setting, "0.1")
    assert train(samples_from(three_people).usable, TINY).id == train(samples, TINY).id


@each_preset
def test_samples_are_left_as_they_were(samples: list[SegmentSample], preset: Preset) -> None:
    before = digest_of(samples)
    train(samples, preset)
    assert digest_of(samples) == before


@each_preset
def test_the_description_says_what_it_was_made_of(samples: list[SegmentSample], preset: Preset) -> None:
    about = train(samples, preset, seed=5).metadata.model_dump()
    assert about["labels"] == sorted(HAND_PATHS)
    assert about["persons"] == ["1", "2", "3"]
    assert (about["preset"], about["seed"], about["samples"]) == (preset.name, 5, len(samples))
    assert about["parameters"]["beta"] == preset.beta
    assert about["data_digest"] == digest_of(samples)


def test_the_digest_tells_samples_apart(samples: list[SegmentSample]) -> None:
    one, *rest = samples
    fields = ("stamps_ns", "joints", "motion", "postures", "velocities")
    altered = [replace(one, **{name: np.nextafter(getattr(one, name), 99)}) for name in fields[1:]]
    altered += [replace(one, stamps_ns=one.stamps_ns + 1), replace(one, label="other"), replace(one, person="other")]
    altered += [replace(one, depth_inferred=True)]
    digests = [digest_of([each, *rest]) for each in altered]
    assert len({*digests, digest_of(samples), digest_of(samples[::-1]), digest_of(rest)}) == len(altered) + 3


@each_preset
@pytest.mark.parametrize("known", [[], ["lift"]])
def test_fewer_than_two_actions_are_refused(samples: list[SegmentSample], preset: Preset, known: list[str]) -> None:
    with pytest.raises(TrainingError, match="at least two actions"):
        train([sample for sample in samples if sample.label in known], preset)


STAGES_OF_TRAINING = [
    (
        TINY,
        [
            ("maps of the first layer", len(MAP_INPUTS)),
            ("pooling of examples", 1),
            ("discriminant axes", len(TINY.stages) + 1),
            ("map of actions", TINY.concept_epochs),
            ("neurons", TINY.epochs),
        ],
    ),
    (
        TINY_PAPER,
        [
            ("layer 1", TINY_PAPER.layer1.steps),
            ("layer 2", TINY_PAPER.layer2.steps),
            ("layer 3", TINY_PAPER.epochs),
        ],
    ),
]


@pytest.mark.parametrize(("preset", "stages"), STAGES_OF_TRAINING, ids=["tiny", "tiny paper"])
def test_progress_names_every_stage_to_its_end(
    samples: list[SegmentSample], preset: Preset, stages: list[tuple[str, int]]
) -> None:
    told: list[tuple[str, int, int]] = []
    train(samples, preset, progress=lambda *done: told.append(done))
    assert [(stage, total) for stage, done, total in told if done == total] == stages


@each_preset
def test_two_samples_of_one_person_are_enough(samples: list[SegmentSample], preset: Preset) -> None:
    """Nobody is there to be held out, and the same model comes of it each time."""
    two = [next(sample for sample in samples if sample.label == label) for label in ("lift", "push")]
    model = train(two, preset)
    assert labels(model, two) == ["lift", "push"]
    assert train(two, preset).id == model.id


@each_preset
def test_each_action_may_be_another_persons(samples: list[SegmentSample], preset: Preset) -> None:
    """Whoever is held out takes all that is known of an action along."""
    pairs = (("lift", "1"), ("push", "2"), ("swing", "3"))
    for count in (2, 3):
        own = [sample for sample in samples if (sample.label, sample.person) in pairs[:count]]
        assert labels(train(own, preset), own) == [sample.label for sample in own]


@each_preset
def test_the_shortest_samples_are_enough(samples: list[SegmentSample], preset: Preset) -> None:
    names = ("stamps_ns", "joints", "motion", "postures", "velocities")
    short = [replace(sample, **{name: getattr(sample, name)[-3:] for name in names}) for sample in samples]
    assert labels(train(short, preset), short) == [sample.label for sample in samples]


@each_preset
def test_samples_that_are_all_the_same_make_a_model_that_answers(samples: list[SegmentSample], preset: Preset) -> None:
    one = samples[0]
    still = replace(
        one,
        joints=np.tile(one.joints[:1], (20, 1, 1)),
        motion=np.zeros((20, 5)),
        postures=np.tile(one.postures[:1], (20, 1, 1)),
        velocities=np.zeros((20, 15, 3)),
    )
    alike = [replace(still, label=sample.label, person=sample.person) for sample in samples]
    model = train(alike, preset)
    found = answer(model, encoded(model, still))
    assert np.isfinite([found.confidence, *found.activations.values()]).all()
