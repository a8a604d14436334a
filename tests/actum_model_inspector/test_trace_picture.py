import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from actum.node import SECOND_NS
from actum.som import Som
from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.style import LEFT, RIGHT
from actum_model_inspector.trace_picture import SHIFT, TIME_COLOURS, free_side, shifted_right, trace_picture
from actum_model_trainer.answering import encoded
from actum_model_trainer.samples import SegmentSample
from recognisers import in_a_mirror, tiny_model, tiny_samples
from som_classifier.model_maps import maps_of

ABOVE, BELOW = -1, 1
BONES_OF_A_SIDE = ["elbow", "hand", "knee", "foot"]
"""By their farther end, in the order in which they are drawn."""


def picture_of(answered: AnsweredSegment) -> Figure:
    maps = maps_of(tiny_model())
    assert maps is not None
    return trace_picture(maps, answered)


def test_steps_there_and_back_lie_side_by_side_each_on_its_right() -> None:
    """The picture's y points down: the right of a step along x has the larger y."""
    there_and_back = np.array([[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [0.0, 0.0]]])
    assert np.allclose(shifted_right(there_and_back)[:, :, 1], [[SHIFT, SHIFT], [-SHIFT, -SHIFT]])
    assert np.allclose(shifted_right(there_and_back)[:, :, 0], there_and_back[:, :, 0])


@pytest.mark.parametrize(
    ("unit", "others", "preferred", "side"),
    [
        (4, [3, 5], ABOVE, ABOVE),
        (4, [3, 5], BELOW, BELOW),
        (4, [1], ABOVE, BELOW),
        (4, [7], BELOW, ABOVE),
        (4, [1, 7], ABOVE, ABOVE),
        (1, [], ABOVE, BELOW),
        (1, [4], ABOVE, BELOW),
        (7, [], BELOW, ABOVE),
    ],
)
def test_a_name_covers_no_unit_of_the_way_and_stays_on_the_map(
    unit: int, others: list[int], preferred: int, side: int
) -> None:
    visited = np.array([unit, *others])
    assert free_side(Som(3, 3, np.zeros((9, 1))), unit, visited, preferred) == side


def test_on_a_map_of_one_row_a_name_stands_where_it_is_wanted() -> None:
    assert free_side(Som(1, 3, np.zeros((3, 1))), 1, np.array([1]), BELOW) == BELOW


@pytest.mark.parametrize(
    ("sample", "left_handed"), [(tiny_samples()[0], False), (in_a_mirror(tiny_samples()[0]), True)]
)
def test_the_way_of_a_left_hander_is_that_of_the_mirror_image_and_says_so(
    sample: SegmentSample, left_handed: bool
) -> None:
    model = tiny_model()
    answered = AnsweredSegment("file", "1", "a", sample.label, encoded(model, sample))
    title = picture_of(answered).axes[0].get_title(loc="left")
    assert title.startswith(f"{len(model.trace(encoded(model, sample)))} stays")
    assert ("read in a mirror" in title) == left_handed


@pytest.mark.parametrize(("sample", "moving"), [(tiny_samples()[0], RIGHT), (in_a_mirror(tiny_samples()[0]), LEFT)])
def test_the_framed_figures_move_the_arm_that_the_actor_moved(sample: SegmentSample, moving: str) -> None:
    model = tiny_model()
    answered = AnsweredSegment("file", "1", "a", sample.label, encoded(model, sample))
    axes = picture_of(answered).axes[0]
    (figures,) = (drawn for drawn in axes.collections if isinstance(drawn, LineCollection) and drawn.get_zorder() == 5)
    spread = {}
    for side in (RIGHT, LEFT):
        own = (figures.get_colors() == to_rgba(side)).all(axis=1)
        bones = np.array([bone for bone, of_side in zip(figures.get_segments(), own, strict=True) if of_side])
        lengthwise = bones.reshape(-1, len(BONES_OF_A_SIDE), 2, 2)
        forearms = lengthwise[:, BONES_OF_A_SIDE.index("hand")]
        spread[side] = np.ptp(forearms[:, 1] - forearms[:, 0], axis=0).max()
    assert spread[moving] > 2 * min(spread.values())


def test_stays_are_framed_in_the_colour_of_their_time_whatever_frames_were_lost() -> None:
    model, sample = tiny_model(), tiny_samples()[0]
    frames = encoded(model, sample)
    for frame in frames[-2:]:
        frame.stamp_ns += 100 * SECOND_NS
    answered = AnsweredSegment("file", "1", "a", sample.label, frames)
    early = {tuple(card.get_edgecolor()) for card in picture_of(answered).axes[0].patches}
    assert {TIME_COLOURS(0.0)} <= early <= {TIME_COLOURS(0.0), TIME_COLOURS(1), TIME_COLOURS(2), TIME_COLOURS(0.88)}
