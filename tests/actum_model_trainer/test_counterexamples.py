"""What is labelled as none of the actions is learnt as such, and by the verifier alone."""

from dataclasses import replace
from functools import cache

import numpy as np

from actum.messages import NONE
from actum_model_trainer.background import counterexamples, negatives_of, shipped
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.spotting.spotting_training import with_spotting
from actum_model_trainer.training import train_to_spot
from performers import TINY
from som_classifier.model import Model
from unmarked import encoded_live, scene, spotting_model, taught


@cache
def clips() -> tuple[LabelledStream, ...]:
    """Each swing that was taught, on its own and said to be none of the actions."""
    named = [
        replace(stream, segments=tuple((*bounds, NONE) for *bounds, label in stream.segments if label == "swing"))
        for stream in taught().streams
    ]
    return tuple(counterexamples(named))


@cache
def corrected() -> Model:
    return train_to_spot(taught().usable, [*taught().streams, *clips()], TINY)


def test_a_counterexample_is_the_frames_of_its_segment_and_no_others() -> None:
    [first, *_] = clips()
    [(start_ns, end_ns, label)] = first.segments
    assert (first.stamps_ns[0], first.stamps_ns[-1], label) == (start_ns, end_ns, NONE)
    assert len(first.postures) == len(first.velocities) == len(first.motion) == len(first.stamps_ns)


def test_only_what_shows_nothing_else_is_a_counterexample() -> None:
    stream = taught().streams[0]
    labelled = tuple((start_ns, end_ns, NONE) for start_ns, end_ns, _ in stream.segments)
    assert not stream.is_counterexample and not replace(stream, segments=labelled[:2]).is_counterexample
    assert all(clip.is_counterexample for clip in clips())


def test_counterexamples_are_negatives_beside_windows_of_the_background() -> None:
    durations_s, rng = np.array([1.0]), np.random.default_rng
    drawn = negatives_of(shipped(), durations_s, 5, rng(0))
    both = negatives_of([*shipped(), *clips()], durations_s, 5, rng(0))
    assert len(both) == len(drawn) + len(clips())
    assert all(np.array_equal(each.postures, clip.postures) for each, clip in zip(both, clips(), strict=False))


def test_what_is_said_to_be_none_is_less_like_its_action_and_others_are_as_before() -> None:
    before, after = familiarities(spotting_model()), familiarities(corrected())
    assert after["swing"] < before["swing"] - 0.1
    assert all(abs(after[label] - before[label]) < 0.1 for label in ("lift", "push"))


def test_the_search_learns_nothing_from_counterexamples() -> None:
    model = replace(spotting_model(), heads=None)
    alone, beside = (
        with_spotting(model, streams, TINY, 0, lambda *_: None)
        for streams in (taught().streams, [*taught().streams, *clips()])
    )
    assert alone.heads is not None and beside.heads is not None
    assert np.array_equal(alone.heads.axes, beside.heads.axes)
    assert alone.metadata.spotting == beside.metadata.spotting


def familiarities(model: Model) -> dict[str, float]:
    """The mean familiarity of what somebody else does, by action."""
    found: dict[str, list[float]] = {}
    of = scene(seed=9)
    frames = encoded_live(model, of)
    for act in of.acts:
        recognition = model.recognise(frames[act.first : act.last + 1], complete=True)
        if recognition.label == act.action:
            found.setdefault(act.action, []).append(recognition.familiarity or 0.0)
    return {label: float(np.mean(each)) for label, each in found.items()}
