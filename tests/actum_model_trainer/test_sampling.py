"""Of recordings that do not fit into memory an even selection is kept, the same in whatever order they are read."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from actum_model_trainer import sampling
from actum_model_trainer.samples import Samples, Unusable
from actum_model_trainer.sampling import Sampling, even_quota, pieces
from unmarked import taught


def parts(copies: int) -> list[Samples]:
    """What so many recordings hold: in each three actions six times, and a stream."""
    one = taught()
    streams = [one.streams[0]]
    return [
        Samples(
            [replace(each, file=f"{n}.mcap") for each in one.usable if each.person == "1"],
            [replace(each, file=f"{n}.mcap") for each in streams],
        )
        for n in range(copies)
    ]


def kept(of: Sequence[Samples]) -> Sampling:
    whole = Sampling()
    for each in of:
        whole.add(each)
    return whole


def test_all_that_fits_is_kept_in_its_order() -> None:
    whole = kept(parts(2))
    assert whole.remark is None
    files = [each.file for each in whole.samples.segments]
    assert files == ["0.mcap"] * 18 + ["1.mcap"] * 18
    assert [each.file for each in whole.samples.streams] == ["0.mcap", "1.mcap"]


def test_of_too_many_segments_as_many_of_each_action_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 30)
    whole = kept(parts(5))
    assert Counter(each.label for each in whole.samples.usable) == {"lift": 10, "push": 10, "swing": 10}
    assert len({each.file for each in whole.samples.usable}) == 5
    assert whole.remark is not None and "30 of 90 labelled segments" in whole.remark


def test_the_order_of_reading_does_not_change_what_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 30)
    monkeypatch.setattr(sampling, "MOST_STREAM_FRAMES", 3 * len(taught().streams[0].stamps_ns))

    def names(of: Sequence[Samples]) -> tuple[set[tuple[str, str]], set[str]]:
        samples = kept(of).samples
        return {(each.file, each.segment_id) for each in samples.usable}, {each.file for each in samples.streams}

    there = names(parts(6))
    assert len(there[1]) == 3
    assert names(parts(6)[::-1]) == there


def test_what_cannot_be_used_is_still_told() -> None:
    whole = kept([Samples([Unusable("a.mcap", "1", "no person", "left")], [])])
    assert [each.reason for each in whole.samples.unusable] == ["no person"]
    assert whole.remark is None


@pytest.mark.parametrize(
    ("counts", "most", "quota"),
    [([5, 5, 5], 15, 5), ([5, 5, 5], 14, 4), ([1, 20, 20], 21, 10), ([3, 3], 100, 3), ([9, 9, 9], 2, 1), ([], 7, 7)],
)
def test_rare_actions_leave_their_room_to_the_others(counts: list[int], most: int, quota: int) -> None:
    assert even_quota(counts, most) == quota


def test_a_long_stream_is_cut_between_segments_and_nothing_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "LONGEST_PIECE", 300)
    stream = taught().streams[0]
    cut = pieces(stream)
    assert len(cut) > 3 and all(len(piece.stamps_ns) <= 300 for piece in cut)
    assert np.array_equal(np.concatenate([piece.postures for piece in cut]), stream.postures)
    assert [segment for piece in cut for segment in piece.segments] == list(stream.segments)
    for piece in cut:
        assert all(end_ns <= piece.stamps_ns[-1] for _, end_ns, _ in piece.segments)


def test_a_stream_without_a_place_to_cut_is_cut_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "LONGEST_PIECE", 300)
    stream = taught().streams[0]
    whole = replace(stream, segments=((int(stream.stamps_ns[0]), int(stream.stamps_ns[-1]), "lift"),))
    cut = pieces(whole)
    assert all(len(piece.stamps_ns) == 300 for piece in cut[:-1])
    assert sum(len(piece.stamps_ns) for piece in cut) == len(stream.stamps_ns)
    assert [len(piece.segments) for piece in cut] == [1, *[0] * (len(cut) - 1)]


def test_a_short_stream_stays_as_it_is() -> None:
    assert pieces(taught().streams[0]) == [taught().streams[0]]
