"""What the picture that explains an answer says in words and bars."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from actum.recording import Recording
from actum_model_inspector.answered import AnsweredSegment, answered_segments, encoded
from actum_model_inspector.contributions import contributions
from actum_model_inspector.explanation import explanation_picture
from actum_model_inspector.style import LEFT, RIGHT
from actum_model_trainer.answering import encoded as encoded_sample
from recognisers import tiny_samples
from som_classifier.model_maps import PyramidMaps
from som_classifier.pyramid_model import PyramidModel


def of(label: str, model: PyramidModel, recording: Recording) -> AnsweredSegment:
    segments = answered_segments(PyramidMaps(model), [recording])
    return next(segment for segment in segments if segment.label == label)


def without_mirror(model: PyramidModel) -> PyramidModel:
    return replace(model, metadata=model.metadata.model_copy(update={"mirrors": False}))


def words(figure: Figure) -> str:
    return "\n".join(text.get_text() for text in figure.findobj(Text))


def arm_colours(figure: Figure) -> set[str]:
    """Return in which of the two sides' colours the column of arms is drawn."""
    drawn = [lines for lines in figure.axes[-1].collections if isinstance(lines, LineCollection)]
    colours = {tuple(colour) for lines in drawn for colour in lines.get_colors()}
    return {side for side in (RIGHT, LEFT) if to_rgba(side) in colours}


@pytest.mark.parametrize(
    ("label", "mirrors", "arm", "side"),
    [("push", True, "right", RIGHT), ("swing", True, "left", LEFT), ("swing", False, "right", RIGHT)],
)
def test_the_column_of_arms_names_the_arm_that_it_shows(
    pyramid: PyramidModel, recording: Recording, label: str, mirrors: bool, arm: str, side: str
) -> None:
    """The one who swings does so with the left arm; a model that reads nobody in a mirror sees the other one."""
    model = pyramid if mirrors else without_mirror(pyramid)
    figure = explanation_picture(model, of(label, model, recording))
    assert arm_colours(figure) == {side}
    assert f"THE {arm.upper()} ARM" in words(figure)
    assert "ACTING ARM" not in words(figure)
    other = "the left arm moves most, but this was not read in a mirror: the map of arms sees the right one"
    assert (other in words(figure)) == (label == "swing" and not mirrors)


def test_bars_lead_from_nothing_to_the_difference_of_the_scores(pyramid: PyramidModel, recording: Recording) -> None:
    segment = of("lift", pyramid, recording)
    found = contributions(pyramid, encoded(pyramid, segment.frames))
    bars = [patch for patch in explanation_picture(pyramid, segment).axes[0].patches if isinstance(patch, Rectangle)]
    *terms, total = [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in bars]
    assert [begin for begin, _ in terms] == pytest.approx([total[0], *(end for _, end in terms[:-1])])
    assert terms[-1][1] == pytest.approx(total[1], abs=1e-3)
    widths = [end - begin for begin, end in [*terms, total]]
    values = [*found.cells.sum(axis=0), found.bias, found.difference]
    assert widths == pytest.approx([value * widths[-1] / values[-1] for value in values], abs=1e-3)


def test_what_is_the_same_for_every_segment_is_explained(pyramid: PyramidModel, recording: Recording) -> None:
    segment = of("lift", pyramid, recording)
    found = contributions(pyramid, encoded(pyramid, segment.frames))
    said = words(explanation_picture(pyramid, segment))
    assert "before anything is seen" not in said
    assert (
        f"less average\n{found.bias:+.2f}\nthe same for every segment: what the boxes add up to in an average" in said
    )


def test_it_takes_off_what_the_boxes_come_to_in_an_average_segment(pyramid: PyramidModel) -> None:
    """Each action was trained as often as the others, so that an average segment leads to none of them."""
    activities = [[frame.activity for frame in encoded_sample(pyramid, sample)] for sample in tiny_samples()]
    average = np.mean([pyramid.pyramid.vector(pyramid.prefix_sums(each)) for each in activities], axis=0)
    boxes = average @ pyramid.stages.axes[-1]
    leads, levels = (np.subtract.outer(each, each) for each in (boxes, pyramid.stages.offsets[-1]))
    np.testing.assert_allclose(leads, -levels, atol=0.1 * np.abs(levels).max())
