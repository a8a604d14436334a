"""What is labelled as none of the actions is learnt as such, and by the verifier alone."""

from dataclasses import replace
from functools import cache

import numpy as np

from actum.messages import NONE
from actum_model_trainer.background import negatives_of, shipped
from actum_model_trainer.spotting.spotting_training import with_spotting
from actum_model_trainer.training import train_to_spot
from performers import TINY
from som_classifier.model import Model
from unmarked import familiarities, spotting_model, swings_said_to_be_none, taught


@cache
def corrected() -> Model:
    return train_to_spot(taught().usable, [*taught().streams, *swings_said_to_be_none()], TINY)


def test_a_counterexample_is_the_frames_of_its_segment_and_no_others() -> None:
    [first, *_] = swings_said_to_be_none()
    [(start_ns, end_ns, label)] = first.segments
    assert (first.stamps_ns[0], first.stamps_ns[-1], label) == (start_ns, end_ns, NONE)
    assert len(first.postures) == len(first.velocities) == len(first.motion) == len(first.stamps_ns)


def test_only_what_shows_nothing_else_is_a_counterexample() -> None:
    stream = taught().streams[0]
    labelled = tuple((start_ns, end_ns, NONE) for start_ns, end_ns, _ in stream.segments)
    assert not stream.is_counterexample and not replace(stream, segments=labelled[:2]).is_counterexample
    assert all(clip.is_counterexample for clip in swings_said_to_be_none())


def test_counterexamples_are_negatives_beside_windows_of_the_background() -> None:
    durations_s, rng = np.array([1.0]), np.random.default_rng
    drawn = negatives_of(shipped(), durations_s, 5, rng(0))
    both = negatives_of([*shipped(), *swings_said_to_be_none()], durations_s, 5, rng(0))
    assert len(both) == len(drawn) + len(swings_said_to_be_none())
    assert all(
        np.array_equal(each.postures, clip.postures) for each, clip in zip(both, swings_said_to_be_none(), strict=False)
    )


def test_what_is_said_to_be_none_is_less_like_its_action_and_others_are_as_before() -> None:
    before, after = familiarities(spotting_model()), familiarities(corrected())
    assert after["swing"] < before["swing"] - 0.1
    assert all(abs(after[label] - before[label]) < 0.1 for label in ("lift", "push"))


def test_the_search_learns_nothing_from_counterexamples() -> None:
    model = replace(spotting_model(), heads=None)
    alone, beside = (
        with_spotting(model, streams, TINY, 0, lambda *_: None)
        for streams in (taught().streams, [*taught().streams, *swings_said_to_be_none()])
    )
    assert alone.heads is not None and beside.heads is not None
    assert np.array_equal(alone.heads.axes, beside.heads.axes)
    assert alone.metadata.spotting == beside.metadata.spotting
