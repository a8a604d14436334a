"""A model that is updated finds the same segments as before, and learns anew what they are."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train, train_to_spot, update
from performers import TINY, TINY_PAPER
from som_classifier.first_layer import MAP_INPUTS
from som_classifier.model import Model
from som_classifier.presets import Preset, PyramidPreset
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotted import SpottedSegment, SpottingOptions
from unmarked import encoded_live, familiarities, scene, spotting_model, swings_said_to_be_none, taught


@cache
def updated(preset: PyramidPreset = TINY) -> PyramidModel:
    """The model, updated with another seed: trained anew it would have other maps and find other segments."""
    streams = [*taught().streams, *swings_said_to_be_none()]
    model = update(spotting_model(), taught().usable, streams, preset, seed=1)
    assert isinstance(model, PyramidModel)
    return model


def found(model: Model) -> list[SpottedSegment]:
    [spotter] = model.spotters([SpottingOptions()])
    return [each for frame in encoded_live(model, scene(seed=9)) for each in spotter.step(frame).segments]


def test_the_same_segments_are_found() -> None:
    before, after = spotting_model(), updated()
    assert found(after) == found(before) != []
    assert after.metadata.spotting == before.metadata.spotting
    assert after.metadata.updated_from == before.id and before.metadata.updated_from is None
    anew = train_to_spot(taught().usable, taught().streams, TINY, seed=1)
    for name in MAP_INPUTS:
        assert np.array_equal(after.arrays[name], before.arrays[name])
        assert not np.array_equal(anew.arrays[name], before.arrays[name])


def test_they_are_found_also_where_the_preset_now_pools_otherwise() -> None:
    other = updated(replace(TINY, levels=(1, 2), overlap=0.9))
    assert found(other) == found(spotting_model())


def test_what_they_are_is_learnt_anew() -> None:
    before, after = spotting_model(), updated()
    assert after.id != before.id
    said_before, said_after = familiarities(before), familiarities(after)
    assert said_after["swing"] < said_before["swing"] - 0.1
    assert all(abs(said_after[label] - said_before[label]) < 0.1 for label in ("lift", "push"))


def test_an_update_with_nothing_new_names_as_the_training_did() -> None:
    again = update(spotting_model(), taught().usable, taught().streams, TINY)
    frames = encoded_live(again, scene(seed=9))
    answers = [again.recognise(frames[act.first : act.last + 1], complete=True) for act in scene(seed=9).acts]
    assert [answer.label for answer in answers] == [act.action for act in scene(seed=9).acts]


def test_an_arm_is_read_as_the_search_learnt_to_read_it() -> None:
    model = spotting_model()
    other = replace(model, metadata=model.metadata.model_copy(update={"mirrors": not model.metadata.mirrors}))
    again = update(other, taught().usable, taught().streams, TINY)
    assert isinstance(again, PyramidModel) and again.metadata.mirrors == other.metadata.mirrors


def without_search() -> Model:
    return train(taught().usable, TINY)


def all_samples() -> list[SegmentSample]:
    return taught().usable


def without_swings() -> list[SegmentSample]:
    return [each for each in taught().usable if each.label != "swing"]


@pytest.mark.parametrize(
    ("model", "samples", "preset"),
    [
        pytest.param(spotting_model, without_swings, TINY, id="other actions"),
        pytest.param(spotting_model, all_samples, TINY_PAPER, id="another kind"),
        pytest.param(without_search, all_samples, TINY, id="no search"),
    ],
)
def test_what_cannot_be_updated_is_trained_anew(
    model: Callable[[], Model], samples: Callable[[], list[SegmentSample]], preset: Preset
) -> None:
    anew = train_to_spot(samples(), taught().streams, preset)
    assert update(model(), samples(), taught().streams, preset).id == anew.id


def test_one_action_alone_is_refused() -> None:
    lifts = [each for each in taught().usable if each.label == "lift"]
    with pytest.raises(TrainingError, match="examples of at least two actions"):
        update(spotting_model(), lifts, taught().streams, TINY)
