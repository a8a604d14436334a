"""Arrays beside a stream hold the newest rows, however long the stream is and whenever its objects appear."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from action_fusion.intake.buffers import MEMORY_NS, ObjectsBuffer
from action_fusion.intake.columns import FIRST_ROWS, Columns
from action_fusion.intake.stream_samples import ObjectsSample
from actum.node import SECOND_NS

FRAME_NS = SECOND_NS // 30


@given(st.lists(st.integers(0, 5), min_size=1, max_size=200))
def test_the_newest_rows_are_those_added_last(drops: list[int]) -> None:
    """Between two rows up to five old ones are forgotten."""
    columns, kept = Columns(np.int64), 0
    for number in range(10 * len(drops)):
        kept = max(kept + 1 - drops[number % len(drops)], 1)
        columns.append(number, kept)
        assert columns.newest(kept).tolist() == list(range(number + 1 - kept, number + 1))


def test_more_rows_may_be_asked_to_be_kept_than_there_are() -> None:
    columns = Columns(np.int64)
    for number in range(3 * FIRST_ROWS):
        columns.append(number, number + 1 + 100)
    assert columns.newest(3 * FIRST_ROWS).tolist() == list(range(3 * FIRST_ROWS))


def test_an_object_that_appears_late_keeps_all_its_positions() -> None:
    buffer = ObjectsBuffer()
    for number in range(1000):
        positions_m = {1: [0.0] * 3} | ({2: [float(number)] * 3} if number >= 100 else {})
        names = dict.fromkeys(positions_m, "cup")
        buffer.append(ObjectsSample(number * FRAME_NS, "", positions_m, names, frozenset(), {}))
        end_ns = number * FRAME_NS
        sighted = buffer.sightings_of_segment(end_ns - SECOND_NS, end_ns)
        of_segment = [each for each in buffer.of_segment(end_ns - SECOND_NS, end_ns) if 2 in each.positions_m]
        assert len(sighted[2].stamps_ns if 2 in sighted else []) == len(of_segment)
    assert len(sighted[2].stamps_ns) > MEMORY_NS // FRAME_NS
    np.testing.assert_array_equal(sighted[2].positions_m[:, 0], [each.positions_m[2][0] for each in of_segment])
