"""Continuations learn from whole streams, and say which streams or models they cannot learn from."""

from dataclasses import replace

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum_model_trainer.continuation_data import MOST_INSTANTS, fitted_shares, instants_of
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.training import CONTINUATIONS, add_to, train, update, with_continuation
from continued import KINDS, continuation_of, continued, standing_stream, without_continuation
from people import STANDING
from performers import TINY, TINY_PAPER
from som_classifier.continuation import HORIZONS_S
from som_classifier.presets import PRESETS
from unmarked import taught

POSTURE = STANDING - STANDING[2]
HAND = 8


def rising_hand(seconds: float = 6.0, speed_mps: float = 0.1) -> LabelledStream:
    """Somebody whose hand rises evenly; nothing is smoothed."""
    stream = standing_stream(POSTURE, seconds)
    postures = stream.postures.copy()
    postures[:, HAND, 1] += speed_mps * stream.stamps_ns / SECOND_NS
    return replace(stream, postures=postures)


def test_instants_know_what_preceded_and_what_followed() -> None:
    instants = instants_of([rising_hand()])
    for horizon, horizon_s in enumerate(HORIZONS_S):
        known = instants.reach > horizon
        assert instants.moved[known, horizon, HAND, 1] == pytest.approx(np.full(known.sum(), 0.1 * horizon_s))
        assert np.isnan(instants.later[~known, horizon]).all()
    assert (instants.postures - instants.before)[:, HAND, 1] == pytest.approx(np.full(len(instants.moved), 0.025))
    assert (instants.after - instants.postures)[:, HAND, 1] == pytest.approx(np.full(len(instants.moved), 0.025))
    assert not np.delete(instants.moved, HAND, axis=2).any()


def test_the_end_of_a_recording_teaches_the_horizons_before_it() -> None:
    """Of six seconds, one step is needed before an instant, and as many after it as its reach says."""
    reach = instants_of([rising_hand(6.0)]).reach
    assert reach.tolist() == sorted(reach, reverse=True) and set(reach.tolist()) == {1, 2, 3}


def test_nothing_is_learnt_across_a_break() -> None:
    stream = rising_hand(4.0)
    later = replace(stream, stamps_ns=stream.stamps_ns + 60 * SECOND_NS)
    joined = replace(
        stream,
        **{name: np.concatenate([getattr(stream, name), getattr(later, name)])
           for name in ("stamps_ns", "motion", "postures", "velocities")},
    )  # fmt: skip
    assert len(instants_of([joined]).postures) == 2 * len(instants_of([stream]).postures)


def test_the_instants_of_long_recordings_are_thinned_out() -> None:
    assert len(instants_of([standing_stream(POSTURE, 700.0)] * 3).postures) == MOST_INSTANTS


def test_people_are_told_apart_where_there_are_several() -> None:
    streams = [standing_stream(POSTURE, person=person) for person in ("2", "1", "2")]
    assert set(instants_of(streams[:1] * 2).groups.tolist()) == {0, 1}
    groups = instants_of(streams).groups
    assert groups[0] == groups[-1] == 1 and set(groups.tolist()) == {0, 1}


def test_the_share_of_a_displacement_is_the_one_nearest_to_the_truth() -> None:
    """Displacements that are twice too long count half; a single jump does not change that."""
    instants = instants_of([rising_hand()])
    answered, later = 2 * instants.moved, instants.later.copy()
    later[0, :, HAND] += 5.0
    moved, _ = fitted_shares(replace(instants, later=later), answered)
    assert moved == pytest.approx([0.5] * len(HORIZONS_S), abs=0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_streams_make_the_same_continuation(kind: str) -> None:
    again = with_continuation(without_continuation(kind), taught().streams)
    assert again.id == continued(kind).id


@pytest.mark.parametrize("kind", KINDS)
def test_streams_that_are_too_short_are_refused(kind: str) -> None:
    with pytest.raises(TrainingError, match=r"the recordings are too short to train.*at least 0.5 s"):
        with_continuation(without_continuation(kind), [standing_stream(POSTURE, 0.3)])


def test_a_map_of_postures_that_turn_with_the_body_is_refused() -> None:
    model = train(taught().usable, TINY_PAPER)
    with pytest.raises(
        TrainingError, match="axes=upright and origin=hips cannot predict.*train a model with axes=upright and origin"
    ):
        with_continuation(model, taught().streams)


def test_an_updated_model_continues_as_before() -> None:
    model = continued("pyramid")
    updated = update(model, taught().usable, taught().streams, TINY, seed=1)
    assert continuation_of(updated) is continuation_of(model)


def test_a_model_to_which_an_action_is_added_continues_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PRESETS, TINY.name, TINY)
    model = continued("pyramid")
    examples = [replace(sample, label="wave") for sample in taught().usable[:3]]
    added = add_to(model, model.kept, examples, taught().streams)
    assert "wave" in added.labels
    assert continuation_of(added) is continuation_of(model)


def test_a_kind_of_model_that_cannot_continue_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(CONTINUATIONS, "pyramid")
    with pytest.raises(TrainingError, match="models of kind 'pyramid' cannot predict later postures"):
        with_continuation(without_continuation("pyramid"), taught().streams)
