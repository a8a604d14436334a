"""Of recordings that do not fit into memory an even selection is kept, the same in whatever order they are read."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from actum.messages import NONE
from actum.node import SECOND_NS
from actum_model_trainer import sampling
from actum_model_trainer.background import ARRAYS
from actum_model_trainer.samples import LabelledStream, Samples, Unusable
from actum_model_trainer.sampling import Sampling, even_quota, pieces
from unmarked import taught

TAUGHT = ("lift", "push", "swing")


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


def beginning(frames: int) -> LabelledStream:
    """The first frames of a stream."""
    stream = taught().streams[0]
    arrays = {name: getattr(stream, name)[:frames] for name in ("stamps_ns", *ARRAYS)}
    return replace(stream, segments=(), **arrays)


def shuffled(of: Sequence[Samples]) -> list[list[Samples]]:
    """The same in twenty orders."""
    rng = np.random.default_rng(0)
    return [[of[n] for n in rng.permutation(len(of))] for _ in range(20)]


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


def test_the_order_does_not_matter_either_where_the_limit_does_not_divide_evenly(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 10)
    one = taught().usable[0]
    single = [Samples([replace(one, file=f"{n}-{label}.mcap", label=label)], []) for n in range(5) for label in TAUGHT]
    selections = {frozenset(each.file for each in kept(of).samples.usable) for of in shuffled(single)}
    assert [Counter(file[2:-5] for file in each) for each in selections] == [dict.fromkeys(TAUGHT, 3)]


def test_the_order_does_not_matter_either_where_a_short_stream_would_fit_in_the_place_of_a_long_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sampling, "MOST_STREAM_FRAMES", 450)
    for draw in range(20):
        streams = [Samples([], [replace(beginning(400 if n % 2 else 100), file=f"{draw}-{n}.mcap")]) for n in range(6)]
        selections = {frozenset(each.file for each in kept(of).samples.streams) for of in shuffled(streams)}
        assert len(selections) == 1 and all(selections)


def test_the_folder_does_not_change_what_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each job reads its set's takes in a folder of its own."""
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 30)
    monkeypatch.setattr(sampling, "MOST_STREAM_FRAMES", 3 * len(taught().streams[0].stamps_ns))

    def names(folder: str) -> list[str]:
        moved = [
            Samples(
                *([replace(each, file=f"{folder}/{each.file}") for each in of] for of in (part.usable, part.streams))
            )
            for part in parts(6)
        ]
        samples = kept(moved).samples
        return [f"{Path(each.file).name} {each.label}" for each in samples.usable] + [
            Path(each.file).name for each in samples.streams
        ]

    assert names("/data/job-1/takes") == names("/data/job-2/takes")


def test_segments_of_none_of_the_actions_take_no_room_from_actions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 18)
    [part] = parts(1)
    of_none = [replace(each, label=NONE, segment_id=f"none {n}") for n, each in enumerate(part.usable)]
    whole = kept([Samples([*of_none, *part.segments], part.streams)])
    assert len(whole.samples.usable) == 18
    assert whole.remark is None


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


def test_a_segment_that_begins_where_no_frame_is_is_not_lost_when_a_stream_is_cut(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sampling, "LONGEST_PIECE", 300)
    stream = taught().streams[0]
    first_ns = int(stream.stamps_ns[0])
    early = (first_ns - SECOND_NS, first_ns + SECOND_NS // 10, "lift")
    after_ns = int(pieces(stream)[0].stamps_ns[-1]) + 1
    between = (after_ns, after_ns + SECOND_NS // 10, "lift")
    cut = pieces(replace(stream, segments=tuple(sorted([early, between, *stream.segments]))))
    assert early in cut[0].segments and between in cut[1].segments
    assert sum(len(piece.segments) for piece in cut) == len(stream.segments) + 2


def test_a_stream_without_a_place_to_cut_is_cut_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "LONGEST_PIECE", 300)
    stream = taught().streams[0]
    first_ns, cut_ns, last_ns = stream.stamps_ns[[0, 299, -1]].tolist()
    cut = pieces(replace(stream, segments=((first_ns, last_ns, "lift"), (cut_ns, last_ns, "push"))))
    assert all(len(piece.stamps_ns) == 300 for piece in cut[:-1])
    assert sum(len(piece.stamps_ns) for piece in cut) == len(stream.stamps_ns)
    assert [len(piece.segments) for piece in cut] == [2, *[0] * (len(cut) - 1)]


def test_a_short_stream_stays_as_it_is() -> None:
    assert pieces(taught().streams[0]) == [taught().streams[0]]
