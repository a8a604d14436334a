from collections.abc import Callable

import numpy as np
import pytest

from actum.recording import Recording
from actum_model_inspector.answer_timeline import answer_timeline, evenly_spaced
from actum_model_inspector.answered import AnsweredSegment, answered_segments, encoded
from actum_model_inspector.trace_picture import stays
from actum_model_trainer.evaluation import evaluate
from handmade import paper_model, pyramid_model
from people import FRAME_NS
from performers import mark, performance
from som_classifier.map_activity import without_repeats
from som_classifier.model_maps import ModelMaps, PaperMaps, PyramidMaps

Record = Callable[..., Recording]


def test_the_answers_are_those_of_the_live_classifier(maps: ModelMaps, recording: Recording) -> None:
    live = {each.segment_id: each.predicted for each in evaluate(maps.model, [recording]).predictions}
    answered = answered_segments(maps.model, [recording])
    assert {each.segment_id: each.recognition and each.recognition.label for each in answered} == live


def test_a_segment_without_a_label_is_answered_too(maps: ModelMaps, record: Record) -> None:
    skeletons, _ = performance(["push"])
    recording = record(skeletons, [mark("start", 0, "a"), mark("end", 19 * FRAME_NS, "a")])
    (answered,) = answered_segments(maps.model, [recording])
    assert answered.label is None
    assert answered.recognition is not None


def test_a_segment_that_cannot_be_answered_is_kept_without_an_answer(maps: ModelMaps, record: Record) -> None:
    skeletons, _ = performance(["push"])
    recording = record(skeletons, [mark("start", 0, "a", "push"), mark("end", FRAME_NS, "a")])
    (answered,) = answered_segments(maps.model, [recording])
    assert (answered.label, answered.recognition, answered.action_unit) == ("push", None, None)
    assert not answered.correct


def test_a_trace_has_a_point_for_every_stay(maps: ModelMaps, segments: list[AnsweredSegment]) -> None:
    """The winner itself, or the centre of activity about it."""
    for segment in segments:
        frames = encoded(maps.model, segment.frames)
        stayed = maps.postures.coordinates[without_repeats(maps.winners(frames))]
        trace = maps.model.trace(frames)
        assert trace.shape == stayed.shape
        assert isinstance(maps, PaperMaps) or (trace == stayed).all()


def test_a_stay_lasts_until_another_unit_wins() -> None:
    units, begins = stays(np.array([4, 4, 2, 4, 4, 4]))
    assert units.tolist() == [4, 2, 4]
    assert begins.tolist() == [0, 2, 3]


def test_the_timeline_ends_with_the_answer(maps: ModelMaps, segments: list[AnsweredSegment]) -> None:
    for segment in segments:
        timeline = answer_timeline(maps.model, segment)
        assert segment.recognition is not None
        assert maps.model.labels[timeline.winners[-1]] == segment.recognition.label
        assert timeline.confidences[-1] == segment.recognition.confidence
        assert dict(zip(maps.model.labels, timeline.activations[-1], strict=True)) == segment.recognition.activations
        assert (np.diff(timeline.times_s) > 0).all()
        assert len(timeline.times_s) == len(segment.frames) - maps.model.min_frames + 1


def test_the_neurons_answer_at_each_unit_as_if_the_input_lay_there() -> None:
    assert PaperMaps(paper_model()).unit_cosines().argmax(axis=1).tolist() == [0, 1]
    model = pyramid_model()
    answers = PyramidMaps(model).unit_cosines()
    expected = model.layer3.cosines(model.action_map.activity(model.action_map.som.weights[4]))
    assert answers[4] == pytest.approx(expected)


def test_the_action_unit_of_a_segment_is_one_of_the_second_map(
    maps: ModelMaps, segments: list[AnsweredSegment]
) -> None:
    assert all(segment.action_unit in range(len(maps.actions.weights)) for segment in segments)


def test_units_of_the_paper_s_first_map_are_placed_relative_to_the_torso() -> None:
    maps = PaperMaps(paper_model())
    above_hips = maps.postures.weights.reshape(-1, 3, 3) - maps.unit_joints()
    assert above_hips == pytest.approx(np.broadcast_to([0.0, 0.24, 0.0], above_hips.shape))


def test_the_actor_is_drawn_at_even_instants_from_the_first_to_the_last() -> None:
    assert evenly_spaced(np.linspace(0, 7, 71), 6) == [0, 14, 28, 42, 56, 70]


def test_figures_of_the_actor_keep_apart_where_frames_were_lost() -> None:
    assert evenly_spaced(np.array([0.0, 0.1, 0.9, 1.0, 1.1, 4.0, 4.2, 5.0]), 6) == [0, 3, 5, 7]
    assert evenly_spaced(np.array([2.0]), 6) == [0]
