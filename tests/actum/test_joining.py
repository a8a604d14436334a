"""Joined recordings: one rising stream, each recording's inside untouched."""

from hypothesis import given
from hypothesis import strategies as st

from actum.joining import PAUSE_NS, joined
from actum.messages import Objects, Posture, Skeleton

stamp_lists = st.lists(st.integers(0, 2**61), min_size=1, max_size=6, unique=True).map(sorted)


def skeleton(stamp_ns: int, seq: int | None = None, session_id: str = "") -> Skeleton:
    return Skeleton(stamp_ns=stamp_ns, seq=seq, sensor="kinect0", agents=[], session_id=session_id)


def seqs(*recordings: list[int | None]) -> list[int | None]:
    return [m.seq for m in joined([skeleton(i, seq) for i, seq in enumerate(recording)] for recording in recordings)]


@given(
    recordings=st.lists(stamp_lists.map(lambda stamps: [s // 8 for s in stamps]), max_size=5), start_ns=st.integers(0)
)
def test_intervals_are_exact_and_recordings_a_pause_apart(recordings: list[list[int]], start_ns: int) -> None:
    stamps = [m.stamp_ns for m in joined(([skeleton(s) for s in stamps] for stamps in recordings), start_ns)]
    expected, begin_ns = [], start_ns
    for recording in recordings:
        expected += [begin_ns + stamp_ns - recording[0] for stamp_ns in recording]
        begin_ns = expected[-1] + PAUSE_NS
    assert stamps == expected


def test_without_a_start_the_first_recording_keeps_its_stamps() -> None:
    stream = joined([[skeleton(50), skeleton(70)], [], [skeleton(3)]])
    assert [m.stamp_ns for m in stream] == [50, 70, 70 + PAUSE_NS]


def test_the_next_recording_begins_after_the_newest_stamp_even_where_stamps_fell() -> None:
    stream = joined([[skeleton(50), skeleton(40)], [skeleton(3)]])
    assert [m.stamp_ns for m in stream] == [50, 40, 50 + PAUSE_NS]


def test_numbers_go_on_where_the_recording_before_ended_and_gaps_inside_stay() -> None:
    assert seqs([5, 6, 9], [100, 101, 104], [0]) == [5, 6, 9, 10, 11, 14, 15]


def test_each_key_has_its_own_numbers() -> None:
    objects = Objects(stamp_ns=0, seq=40, sensor="kinect0", objects=[])
    stream = joined([[skeleton(0, 3), objects], [objects, skeleton(1, 0)]])
    assert [m.seq for m in stream] == [3, 40, 41, 4]


def test_a_source_that_started_anew_inside_a_recording_counts_from_the_same_base() -> None:
    later = [skeleton(0, 80, "a"), skeleton(1, 81, "a"), skeleton(2, 0, "b"), skeleton(3, 2, "b")]
    assert [m.seq for m in joined([[skeleton(0, 7)], later])] == [7, 8, 9, 8, 10]


def test_a_message_without_a_number_stays_without() -> None:
    assert seqs([None, 1], [None]) == [None, 1, None]


def test_a_postures_frame_before_moves_with_it() -> None:
    nobody = {"sensor": "kinect0", "agent": 0, "valid": False, "reason": "no person", "joints_m": None, "joints": None}
    postures = [
        Posture.model_validate(
            nobody | {"stamp_ns": stamp_ns, "previous_ns": previous_ns, "ego_from_camera": None, "motion": None}
        )
        for stamp_ns, previous_ns in ((100, None), (130, 100), (160, 130))
    ]
    assert [m.previous_ns for m in joined([postures], 1000)] == [None, 1000, 1030]
    assert [m.previous_ns for m in joined([postures[1:]], 0)] == [0, 0]
