import numpy as np
import pytest

from actum.node import SECOND_NS
from actum.som import Som
from model_inspector.anatomy import anatomy_of
from model_inspector.answered import Answered
from model_inspector.trace import COURSE, free_side, trace_picture
from model_trainer.answering import encoded
from model_trainer.samples import SegmentSample
from recognisers import in_a_mirror, tiny_model, tiny_samples

ABOVE, BELOW = -1, 1


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
    answered = Answered("file", "1", "a", sample.label, encoded(model, sample))
    title = trace_picture(anatomy_of(model), answered).axes[0].get_title(loc="left")
    assert title.startswith(f"{len(model.trace(encoded(model, sample)))} stays")
    assert ("read in a mirror" in title) == left_handed


def test_stays_are_framed_in_the_colour_of_their_time_whatever_frames_were_lost() -> None:
    model, sample = tiny_model(), tiny_samples()[0]
    frames = encoded(model, sample)
    for frame in frames[-2:]:
        frame.stamp_ns += 100 * SECOND_NS
    answered = Answered("file", "1", "a", sample.label, frames)
    early = {tuple(card.get_edgecolor()) for card in trace_picture(anatomy_of(model), answered).axes[0].patches}
    assert {COURSE(0.0)} <= early <= {COURSE(0.0), COURSE(1), COURSE(2), COURSE(0.88)}
