from dataclasses import replace

import numpy as np
import pytest

from actum.recording import Recording
from actum_model_inspector.answered import AnsweredSegment, answered_segments, encoded
from actum_model_inspector.contributions import contributions
from actum_model_inspector.explanation import largest_contributors
from handmade import pyramid_model
from som_classifier.first_layer import CHANNELS
from som_classifier.model_maps import PyramidMaps, maps_of
from som_classifier.pyramid_model import PyramidModel


@pytest.fixture(params=["trained", "handmade"])
def model(request: pytest.FixtureRequest, pyramid: PyramidModel) -> PyramidModel:
    return pyramid if request.param == "trained" else pyramid_model()


@pytest.fixture
def segments(model: PyramidModel, recording: Recording) -> list[AnsweredSegment]:
    return answered_segments(PyramidMaps(model), [recording])


def test_contributions_add_up_to_the_difference_of_the_scores(
    model: PyramidModel, segments: list[AnsweredSegment]
) -> None:
    complete = [0.0] * (len(model.metadata.fractions) - 1) + [1.0]
    for segment in segments:
        frames = encoded(model, segment.frames)
        found = contributions(model, frames)
        scores = model.scores([frame.activity for frame in frames], complete)
        assert found.difference == pytest.approx(float(scores[found.winner] - scores[found.other]), abs=1e-5)
        assert found.cells.sum() + found.bias == pytest.approx(found.difference, abs=1e-4)
        assert found.units.sum() == pytest.approx(found.cells.sum(), abs=1e-6)


def test_the_answer_is_held_against_the_one_that_answers_next(
    model: PyramidModel, segments: list[AnsweredSegment]
) -> None:
    for segment in segments:
        found = contributions(model, encoded(model, segment.frames))
        assert segment.recognition is not None
        by_activation = sorted(segment.recognition.activations.items(), key=lambda item: -item[1])
        assert [model.labels[found.winner], model.labels[found.other]] == [label for label, _ in by_activation[:2]]


def test_or_against_another_that_is_named(pyramid: PyramidModel, recording: Recording) -> None:
    (segment, *_) = answered_segments(PyramidMaps(pyramid), [recording])
    frames = encoded(pyramid, segment.frames)
    answer = pyramid.labels[contributions(pyramid, frames).winner]
    for other in set(pyramid.labels) - {answer}:
        assert pyramid.labels[contributions(pyramid, frames, other).other] == other


def test_a_segment_of_the_left_arm_is_known_to_be_read_in_a_mirror(pyramid: PyramidModel, recording: Recording) -> None:
    read = {
        segment.label: contributions(pyramid, encoded(pyramid, segment.frames)).in_mirror
        for segment in answered_segments(maps_of(pyramid), [recording])
    }
    assert read == {"lift": False, "push": False, "swing": True}


def test_each_cell_s_activities_are_shares_of_each_map(pyramid: PyramidModel, recording: Recording) -> None:
    (segment, *_) = answered_segments(PyramidMaps(pyramid), [recording])
    found = contributions(pyramid, encoded(pyramid, segment.frames))
    shares = [1.0, 1.0, *pyramid.metadata.arm_shares]
    np.testing.assert_allclose(found.activities.sum(axis=2), [shares] * 7, atol=1e-3)


def test_the_activities_of_the_whole_are_the_mean_of_its_frames(pyramid: PyramidModel, recording: Recording) -> None:
    (segment, *_) = answered_segments(PyramidMaps(pyramid), [recording])
    frames = encoded(pyramid, segment.frames)
    movements = [frame.kinematics for frame in frames if frame.kinematics is not None]
    sides = [pyramid.first.frame_activities(movement.posture, movement.velocity)[0] for movement in movements]
    whole = contributions(pyramid, frames).activities[0]
    np.testing.assert_allclose(whole.ravel(), np.mean(sides, axis=0), atol=1e-5)


@pytest.mark.parametrize("which", range(len(CHANNELS)))
def test_each_map_adds_what_its_own_axes_make_of_it(
    model: PyramidModel, segments: list[AnsweredSegment], which: int
) -> None:
    """Where only the axes of one map are not zero, the others add nothing."""
    parts = model.pyramid.cells, len(CHANNELS), len(model.first.arms.weights), len(model.labels)
    axes = np.zeros((len(model.stages.axes), *parts), np.float32)
    axes[:, :, which] = model.stages.axes.reshape(axes.shape)[:, :, which]
    of_one = replace(model, stages=replace(model.stages, axes=axes.reshape(model.stages.axes.shape)))
    found = contributions(of_one, encoded(of_one, segments[0].frames))
    assert found.cells.any(axis=0).tolist() == [index == which for index in range(len(CHANNELS))]
    assert found.cells[:, which].sum() + found.bias == pytest.approx(found.difference, abs=1e-4)


def test_the_largest_contributors_are_those_with_the_sign_of_the_sum() -> None:
    chosen, shares = largest_contributors(np.array([0.1, -0.5, 0.3, 0.0, 0.0, 0.0, 0.0, 0.6]))
    assert chosen[:3].tolist() == [7, 2, 0]
    assert shares[:3] == pytest.approx([0.6, 0.3, 0.1])
    chosen, _ = largest_contributors(np.array([0.1, -0.5, 0.3]))
    assert chosen[0] == 1


def test_where_nothing_contributes_all_count_alike() -> None:
    assert largest_contributors(np.zeros(3))[1] == pytest.approx(np.ones(3) / 3)
