"""The answers over time end with the answer that is given."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.patches import Rectangle

from actum.recording import Recording
from actum_model_inspector.answer_timeline import timeline_picture
from actum_model_inspector.answered import AnsweredSegment, answered_segments
from actum_model_inspector.style import action_colours
from som_classifier.model_maps import ModelMaps
from som_classifier.pyramid_model import PyramidModel


@pytest.fixture
def surprised(pyramid: PyramidModel) -> PyramidModel:
    """A model that takes actions to last ten times as long, and hears at their end that they do not."""
    longer = pyramid.stages.log_duration_mean + np.log(10)
    return replace(pyramid, stages=replace(pyramid.stages, log_duration_mean=longer))


def test_the_last_bar_and_the_last_points_are_the_printed_answer(surprised: PyramidModel, recording: Recording) -> None:
    for segment in answered_segments(surprised, [recording]):
        recognition = segment.recognition
        assert recognition is not None
        lines, decision = timeline_picture(surprised, segment).axes[:2]
        bars = [patch for patch in decision.patches if isinstance(patch, Rectangle)]
        colour = action_colours(len(surprised.labels))[surprised.labels.index(recognition.label)]
        assert bars[-1].get_height() == recognition.confidence
        np.testing.assert_allclose(to_rgb(bars[-1].get_facecolor()), colour)
        assert max(line.get_ydata()[-1] for line in lines.lines) == recognition.activations[recognition.label]
        said = [text.get_text() for text in decision.texts]
        assert f"answer at the end:\n{recognition.label} {recognition.confidence:.2f}" in said


def test_the_bars_cover_the_whole_time(maps: ModelMaps, segments: list[AnsweredSegment]) -> None:
    decision = timeline_picture(maps.model, segments[0]).axes[1]
    bars = [patch for patch in decision.patches if isinstance(patch, Rectangle)]
    ends = [bar.get_x() + bar.get_width() for bar in bars]
    assert bars[0].get_x() == 0
    np.testing.assert_allclose(ends[:-1], [bar.get_x() for bar in bars[1:]])
    assert ends[-1] == pytest.approx(decision.get_xlim()[1])
    assert min(bar.get_width() for bar in bars) > 0
