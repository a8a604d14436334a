"""Examples are added to a trained model: it knows the new action, keeps its maps, and still knows the others."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from actum_model_trainer.provenance import TrainingError, digest_of
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample
from actum_model_trainer.training import add_to, train, train_to_spot, update
from people import STANDING
from performers import TINY, TINY_PAPER, posed
from repeating import eased
from som_classifier.first_layer import MAP_INPUTS
from som_classifier.model import NOTHING_KEPT, Model
from som_classifier.model_loading import kept_in, load_model
from som_classifier.presets import PRESETS
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotted import SpottingOptions
from unmarked import Act, Scene, bounds_ns, encoded_live, recorded, scene, swings_said_to_be_none, taught

NEW = "swing"
FEW = 5


@pytest.fixture(autouse=True)
def _tiny_is_a_preset(monkeypatch: pytest.MonkeyPatch) -> None:
    for preset in (TINY, TINY_PAPER):
        monkeypatch.setitem(PRESETS, preset.name, preset)


def old_samples() -> list[SegmentSample]:
    return [sample for sample in taught().usable if sample.label != NEW]


def new_samples() -> list[SegmentSample]:
    return [sample for sample in taught().usable if sample.label == NEW][:FEW]


def streams_without_swings() -> list[LabelledStream]:
    return [replace(each, segments=_others(each)) for each in taught().streams]


@cache
def without_swings() -> PyramidModel:
    model = train_to_spot(old_samples(), streams_without_swings(), TINY)
    assert isinstance(model, PyramidModel)
    return model


def _others(stream: LabelledStream) -> tuple[tuple[int, int, str], ...]:
    return tuple(segment for segment in stream.segments if segment[2] != NEW)


@cache
def with_swings() -> PyramidModel:
    model = add_to(without_swings(), without_swings().kept, new_samples(), taught().streams)
    assert isinstance(model, PyramidModel)
    return model


@cache
def trained_anew() -> Model:
    """A model that was trained on the old and the new examples at once."""
    return train_to_spot([*old_samples(), *new_samples()], taught().streams, TINY)


def named(model: Model) -> list[str]:
    """What a model calls each action of somebody else's scene."""
    of = scene(seed=9)
    frames = encoded_live(model, of)
    return [model.recognise(frames[act.first : act.last + 1], complete=True).label for act in of.acts]


def found(model: Model) -> list[str]:
    """The actions that a model finds in that scene without marks, in order."""
    [spotter] = model.spotters([SpottingOptions()])
    return [each.label for frame in encoded_live(model, scene(seed=9)) for each in spotter.step(frame).segments]


def done() -> list[str]:
    return [act.action for act in scene(seed=9).acts]


def test_an_added_action_is_recognised_and_the_others_still_are() -> None:
    assert NEW not in named(without_swings()) and NEW in done()
    assert named(with_swings()) == done()


def test_an_added_action_is_found_without_marks() -> None:
    assert NEW not in found(without_swings())
    assert found(with_swings()) == done()


def test_the_maps_stay() -> None:
    for name in MAP_INPUTS:
        assert np.array_equal(with_swings().arrays[name], without_swings().arrays[name])


def test_the_metadata_describe_all_examples() -> None:
    before, after = without_swings().metadata, with_swings().metadata
    assert after.labels == sorted([*before.labels, NEW])
    assert after.samples == before.samples + FEW
    assert after.updated_from == without_swings().id
    assert after.data_digest != before.data_digest
    assert set(after.held_out) == set(after.labels)


def test_a_file_keeps_what_is_needed_and_a_classifier_does_not_read_it(tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    without_swings().save(path)
    model = load_model(path)
    assert isinstance(model, PyramidModel) and not model.kept
    assert model.id == without_swings().id
    again = add_to(model, kept_in(path), new_samples(), taught().streams)
    assert again.id == with_swings().id


def test_more_actions_can_be_added_one_after_the_other() -> None:
    lifts = [sample for sample in old_samples() if sample.label != "push"]
    pushes = [sample for sample in old_samples() if sample.label == "push"]
    model = train(lifts + new_samples(), TINY)
    assert isinstance(model, PyramidModel)
    for samples in (pushes[:3], pushes[3:]):
        model = add_to(model, model.kept, samples, [])
        assert isinstance(model, PyramidModel)
    assert named(model) == done()
    assert model.metadata.samples == len(old_samples()) + FEW


def test_a_model_that_keeps_nothing_is_refused() -> None:
    with pytest.raises(TrainingError, match="contains no training data.*train the model again"):
        add_to(without_swings(), NOTHING_KEPT, new_samples(), [])


@pytest.mark.parametrize(
    ("kept", "said"),
    [
        pytest.param(lambda kept: {n: a for n, a in kept.items() if n != "kept_background"}, "damaged", id="missing"),
        pytest.param(
            lambda kept: kept | {"kept_labels": np.char.add(kept["kept_labels"], "x")},
            "belongs to another model",
            id="other",
        ),
        pytest.param(
            lambda kept: kept | {"kept_pooled_directions": kept["kept_pooled_directions"][1:]},
            "belongs to another model",
            id="shape",
        ),
        pytest.param(
            lambda kept: kept | {"kept_stage_0_samples": kept["kept_stage_0_samples"] + 1000},
            "damaged .*stage_0_samples refers to more samples than the",
            id="sample",
        ),
        pytest.param(
            lambda kept: kept | {"kept_window_completeness": kept["kept_window_completeness"][1:]},
            "damaged .*window_completeness has the shape",
            id="window",
        ),
        pytest.param(
            lambda kept: {n: a for n, a in kept.items() if n != "kept_window_share"}, "damaged", id="missing share"
        ),
        pytest.param(
            lambda kept: {n: a for n, a in kept.items() if not n.startswith("kept_window")},
            "lacks the training data for finding actions without marks",
            id="no windows",
        ),
    ],
)
def test_what_does_not_fit_the_model_is_refused(kept: Callable[[Any], Any], said: str) -> None:
    with pytest.raises(TrainingError, match=f"{said}.*train the model again"):
        add_to(without_swings(), kept(dict(without_swings().kept)), new_samples(), [])


def test_recordings_without_examples_are_refused() -> None:
    with pytest.raises(TrainingError, match="none shows a usable skeleton: record the action again"):
        add_to(without_swings(), without_swings().kept, [], [])


def test_a_model_of_the_paper_is_refused() -> None:
    with pytest.raises(TrainingError, match="no action can be added to a model of preset tiny paper"):
        add_to(train(old_samples(), TINY_PAPER), NOTHING_KEPT, new_samples(), [])


def test_an_update_adds_where_only_new_actions_have_come() -> None:
    before, every = without_swings(), [*old_samples(), *new_samples()]
    after = update(before, every, taught().streams, TINY, kept=before.kept)
    assert isinstance(after, PyramidModel)
    assert after.metadata.updated_from == before.id
    assert after.metadata.data_digest == digest_of(every)
    assert named(after) == done()


def test_an_update_trains_anew_where_anything_else_has_changed() -> None:
    before, every = without_swings(), [*old_samples(), *new_samples()]
    corrected = update(before, every[1:], taught().streams, TINY, kept=before.kept)
    assert corrected.id == train_to_spot(every[1:], taught().streams, TINY).id


def background_take() -> LabelledStream:
    """A stream in which nothing is labelled."""
    return replace(taught().streams[0], file="background.mcap", segments=(), person="9")


def test_an_update_trains_anew_where_background_or_counterexamples_have_come() -> None:
    before, every = without_swings(), [*old_samples(), *new_samples()]
    for beside in (swings_said_to_be_none(), (background_take(),)):
        streams = [*taught().streams, *beside]
        after = update(before, every, streams, TINY, kept=before.kept)
        assert after.id == train_to_spot(every, streams, TINY).id


def test_an_update_trains_anew_where_counterexamples_are_gone() -> None:
    before = train_to_spot(old_samples(), [*streams_without_swings(), *swings_said_to_be_none()], TINY)
    every = [*old_samples(), *new_samples()]
    after = update(before, every, taught().streams, TINY, kept=before.kept)
    assert after.id == trained_anew().id


def test_an_update_adds_where_background_and_counterexamples_are_as_they_were() -> None:
    beside = [background_take(), *(replace(each, file="none.mcap") for each in swings_said_to_be_none()[:2])]
    before = train_to_spot(old_samples(), [*streams_without_swings(), *beside], TINY)
    every = [*old_samples(), *new_samples()]
    after = update(before, every, [*taught().streams, *beside], TINY, kept=before.kept)
    assert isinstance(after, PyramidModel) and after.metadata.updated_from == before.id


def test_segments_of_none_of_the_actions_cannot_be_added() -> None:
    streams = [*taught().streams, *swings_said_to_be_none()]
    with pytest.raises(TrainingError, match="contains segments with the label 'none'. Such segments cannot be added"):
        add_to(without_swings(), without_swings().kept, new_samples(), streams)


def test_actions_can_be_added_after_an_update_of_the_others() -> None:
    before = without_swings()
    updated = update(before, old_samples(), streams_without_swings(), TINY, seed=1, kept=before.kept)
    assert isinstance(updated, PyramidModel)
    added = add_to(updated, updated.kept, new_samples(), taught().streams)
    assert named(added) == done() and found(added) == done()


@cache
def updated_without_kept() -> PyramidModel:
    """A model of a file that kept nothing, updated: it still finds actions."""
    updated = update(without_swings(), old_samples(), streams_without_swings(), TINY, seed=1, kept=NOTHING_KEPT)
    assert isinstance(updated, PyramidModel) and updated.spotting is not None
    return updated


def test_an_update_does_not_lose_the_search_where_nothing_of_it_is_kept() -> None:
    updated, every = updated_without_kept(), [*old_samples(), *new_samples()]
    after = update(updated, every, taught().streams, TINY, kept=updated.kept)
    assert after.id == trained_anew().id
    assert after.spotting is not None


def test_nothing_is_added_to_a_model_that_keeps_nothing_of_its_search() -> None:
    updated = updated_without_kept()
    with pytest.raises(
        TrainingError, match="lacks the training data for finding actions without marks.*train the model again"
    ):
        add_to(updated, updated.kept, new_samples(), taught().streams)


def test_an_update_of_a_model_without_a_search_does_not_add_to_it() -> None:
    before, every = train(old_samples(), TINY), [*old_samples(), *new_samples()]
    assert update(before, every, taught().streams, TINY, kept=before.kept).spotting is not None


@pytest.mark.parametrize("name", ["kept_pooled_mean", "kept_window_share", "kept_window_completeness"])
def test_an_update_treats_damaged_arrays_as_none(name: str) -> None:
    before, every = without_swings(), [*old_samples(), *new_samples()]
    damaged = {each: array for each, array in before.kept.items() if each != name}
    same = update(before, old_samples(), streams_without_swings(), TINY, seed=1, kept=damaged)
    assert same.id == updated_without_kept().id
    more = update(before, every, taught().streams, TINY, kept=damaged)
    assert more.id == trained_anew().id


def slow_and_fast(actions: Sequence[str], seed: int, height: float) -> Scene:
    """Swings last half a second, everything else two seconds and a half."""
    rng = np.random.default_rng(seed)
    joints, acts = [], []
    for action in actions:
        joints += [(STANDING + rng.normal(0, 0.0005, (15, 3))) * height for _ in range(30)]
        frames = int((15 if action == NEW else 75) * rng.uniform(0.85, 1.15))
        acts.append(Act(len(joints), len(joints) + frames - 1, action))
        joints += [posed(action, phase, height, rng) for phase in eased(frames)]
    joints += [(STANDING + rng.normal(0, 0.0005, (15, 3))) * height for _ in range(30)]
    return Scene(np.array(joints), tuple(acts))


def test_an_added_action_that_is_much_shorter_than_the_others_is_found(tmp_path: Path) -> None:
    def shown(name: str, actions: Sequence[str]) -> Samples:
        scenes = [slow_and_fast(actions, seed, height) for seed, height in ((1, 0.95), (2, 1.1))]
        return samples_from(
            [recorded(tmp_path, f"{name}{n}", [*of.skeletons(), *of.marks()], str(n)) for n, of in enumerate(scenes)]
        )

    old, new = shown("old", ("lift", "push") * 6), shown("new", (NEW,) * 5)
    before = train_to_spot(old.usable, old.streams, TINY)
    added = add_to(before, before.kept, new.usable, new.streams)
    [spotter] = added.spotters([SpottingOptions()])
    test = slow_and_fast(("lift", NEW, "push", NEW), 9, 1.0)
    segments = [each for frame in encoded_live(added, test) for each in spotter.step(frame).segments]
    for start_ns, end_ns, action in bounds_ns(test.acts):
        middles_ns = [(each.start_ns + each.end_ns) / 2 for each in segments if each.label == action]
        assert any(start_ns <= middle_ns <= end_ns for middle_ns in middles_ns)
