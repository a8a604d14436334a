"""Of many samples, vectors are kept as coordinates: the model is nearly that of whole vectors, and takes additions."""

from collections import Counter

import numpy as np
import pytest

from actum_model_trainer import gathering, pooling, pyramid_training
from actum_model_trainer.gathering import Taught
from actum_model_trainer.training import add_to, train
from performers import TINY
from som_classifier.presets import PRESETS
from som_classifier.pyramid_model import PyramidModel
from unmarked import encoded_live, scene, taught

FEW = 10
"""Samples beyond which there are many; the set has 36."""
TAUGHT = ("lift", "push", "swing")


@pytest.fixture(autouse=True)
def _one_vector_of_each_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pooling, "MAX_VECTORS", FEW)


def trained() -> PyramidModel:
    model = train(taught().usable, TINY)
    assert isinstance(model, PyramidModel)
    return model


def scores(model: PyramidModel) -> np.ndarray:
    of = scene(seed=9)
    frames = encoded_live(model, of)
    evidence = [model.evidence(frames[act.first : act.last + 1]) for act in of.acts]
    return np.array([model.complete_scores(each) for each in evidence])


def test_coordinates_of_many_samples_give_nearly_the_scores_of_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = trained()
    monkeypatch.setattr(gathering, "MAX_VECTORS", FEW)
    reduced = trained()
    assert reduced.id != whole.id
    for name in ("postures", "velocities", "arms"):
        assert np.array_equal(reduced.arrays[name], whole.arrays[name])
    np.testing.assert_allclose(scores(reduced), scores(whole), atol=0.05)


def test_samples_are_thinned_out_evenly_over_the_actions_in_whatever_order_they_are_read() -> None:
    samples = taught().usable
    assert [each.label for each in samples][:4] == ["lift", "push", "swing", "lift"]
    of_all = Taught.of(samples, mirrors=False, preset=TINY, seed=0)
    for stride in (2, 3, 6):
        numbers = of_all.every(stride)
        assert Counter(samples[number].label for number in numbers) == dict.fromkeys(TAUGHT, 12 // stride)
        assert numbers == sorted(numbers)
    assert of_all.every(1) == list(range(len(samples)))


def test_maps_are_trained_on_every_action_although_only_each_third_sample_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the order of reading, every third sample is a lift."""
    of_all = Taught.of(taught().usable, mirrors=False, preset=TINY, seed=0)
    frames = sum(len(each) * len(each[0].measured[0]) for each in of_all.augmented)
    monkeypatch.setattr(pyramid_training, "MOST_FRAMES", frames // 3 + 1)
    first = {id(each[0]): sample.label for each, sample in zip(of_all.augmented, of_all.samples, strict=True)}
    some = pyramid_training._some(of_all)
    assert Counter(first[id(of_sample[0])] for of_sample in some) == dict.fromkeys(TAUGHT, 4)


def test_examples_can_be_added_to_a_model_of_many_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gathering, "MAX_VECTORS", FEW)
    monkeypatch.setitem(PRESETS, TINY.name, TINY)
    model = train([sample for sample in taught().usable if sample.label != "swing"], TINY)
    assert isinstance(model, PyramidModel)
    added = add_to(model, model.kept, [sample for sample in taught().usable if sample.label == "swing"][:5], [])
    assert isinstance(added, PyramidModel)
    named = [added.labels[row.argmax()] for row in scores(added)]
    assert named == [act.action for act in scene(seed=9).acts]


def test_maps_are_trained_on_some_of_very_many_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    every = trained()
    monkeypatch.setattr(pyramid_training, "MOST_FRAMES", 1000)
    some = trained()
    assert not np.array_equal(every.arrays["postures"], some.arrays["postures"])
    assert scores(some).argmax(axis=1).tolist() == scores(every).argmax(axis=1).tolist()
