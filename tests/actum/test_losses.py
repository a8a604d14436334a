"""Which samples of a stream are kept, and whether some of a segment are lost."""

from dataclasses import dataclass
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.losses import LOST_NS, StreamBuffer, longest_loss_s
from actum.node import SECOND_NS

MS = SECOND_NS // 1000
DURATION_MS = 2000


@dataclass(frozen=True)
class Sample:
    stamp_ns: int


def buffer(stamps_ms: list[int], memory_ns: int = 60 * SECOND_NS) -> StreamBuffer[Sample]:
    stream = StreamBuffer[Sample](memory_ns)
    for stamp_ms in stamps_ms:
        stream.append(Sample(stamp_ms * MS))
    return stream


@given(st.lists(st.integers(-1000, 4000), unique=True).map(sorted))
def test_of_a_dense_stream_no_samples_of_a_segment_are_lost(stamps_ms: list[int]) -> None:
    stream = buffer(stamps_ms)
    within_ns = [each.stamp_ns for each in stream.between(0, DURATION_MS * MS)]
    gaps_ns = pairwise([0, *within_ns, DURATION_MS * MS])
    if stream.is_dense(0, DURATION_MS * MS):
        assert longest_loss_s(gaps_ns, 0, DURATION_MS * MS) is None


@pytest.mark.parametrize(
    ("stamps_ms", "dense"),
    [
        ([100, 500, 1000, 1500, 1900], True),
        ([-300, 500, 1000, 1500, 2600], True),
        ([501, 1000, 1500, 1900], False),
        ([100, 500, 1001, 1500, 1900], False),
        ([100, 500, 1000, 1499], False),
        ([], False),
    ],
)
def test_a_stream_is_dense_where_no_two_samples_are_further_apart_than_matters(
    stamps_ms: list[int], dense: bool
) -> None:
    assert LOST_NS == 500 * MS
    assert buffer(stamps_ms).is_dense(0, DURATION_MS * MS) == dense


@given(st.lists(st.integers(1, 400), min_size=1, max_size=40), st.integers(-100, 9000), st.integers(0, 9000))
def test_samples_between_two_stamps_are_those_kept_that_lie_between(steps_ms: list[int], first: int, long: int) -> None:
    stamps_ms = [sum(steps_ms[: n + 1]) for n in range(len(steps_ms))]
    stream = buffer(stamps_ms, memory_ns=2 * SECOND_NS)
    kept = [each for each in stamps_ms if each >= stamps_ms[-1] - 2000]
    assert [each.stamp_ns // MS for each in stream] == kept
    between = stream.between(first * MS, (first + long) * MS)
    assert [each.stamp_ns // MS for each in between] == [each for each in kept if first <= each <= first + long]
