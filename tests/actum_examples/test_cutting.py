"""The repetitions of an action are cut out of a stream that nobody has marked."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.messages import Skeleton
from actum_examples.cutting.choice import Chain
from actum_examples.cutting.courses import BREAK_S, Course, PersonTracks, course_of
from actum_examples.cutting.doubts import doubts_of
from actum_examples.cutting.repetitions import Cuts, cut
from people import FRAME_NS, lacking, skeleton
from repeating import (
    GOGGLES,
    RATE_HZ,
    SCRATCH,
    WAVE,
    Array,
    Stream,
    eased,
    five_waves,
    held,
    moved,
    rest,
    together,
    walk,
)

NEAR_S = 0.6
"""How far a cut's bounds may lie from the truth: a start is slow, and a cut has some rest about it."""
LEFT_RIGHT = [0, 1, 2, 6, 7, 8, 3, 4, 5, 12, 13, 14, 9, 10, 11]
"""Each joint's counterpart on the other side."""


def seen(skeletons: Sequence[Skeleton]) -> list[Course]:
    tracks = PersonTracks()
    for each in skeletons:
        tracks.receive(each)
    return tracks.courses()


def cuts_of(stream: Stream, asked: int | None = 5, noise_m: float = 0.003) -> Cuts:
    cuts = cut(seen(stream.skeletons(noise_m)), asked, 0)
    assert cuts is not None
    return cuts


def assert_at(cuts: Cuts, truths: Sequence[tuple[int, int]], near_s: float = NEAR_S) -> None:
    """Each repetition holds one truth and begins and ends near it."""
    assert len(cuts.repetitions) == len(truths)
    for repetition, (first, last) in zip(cuts.repetitions, truths, strict=True):
        assert abs(repetition.start_ns - first * FRAME_NS) < near_s * 1e9
        assert abs(repetition.end_ns - last * FRAME_NS) < near_s * 1e9


@pytest.mark.parametrize("asked", [5, None])
def test_five_with_pauses_are_five(asked: int | None) -> None:
    stream = five_waves()
    cuts = cuts_of(stream, asked)
    assert_at(cuts, stream.truths)
    assert cuts.sureness > 0.8
    assert cuts.doubts == ()


ONE_WAVE = moved(eased(42), WAVE)
TWO_STROKES = np.concatenate([moved(eased(30), WAVE), rest(0.3), moved(eased(30), WAVE)])
STREAMS = {
    "walking up and back belongs to none": Stream().then(walk(3)).repeat([ONE_WAVE] * 5).then(walk(3)[::-1]),
    "a scratch between belongs to none": (
        Stream().repeat([ONE_WAVE] * 2).then(moved(eased(30), SCRATCH)).repeat([ONE_WAVE] * 3)
    ),
    **{
        f"a hold of the {name}, longer than the pauses, cuts nothing": (
            Stream().then(rest(2)).repeat([moved(held(90), joints)] * 5, pause_s=1.0).then(rest(2))
        )
        for name, joints in (("wave", WAVE), ("goggles", GOGGLES))
    },
    "two strokes with a short stop are one": Stream().repeat([TWO_STROKES] * 5, pause_s=1.5),
    "durations may differ": Stream().repeat([moved(eased(frames), WAVE) for frames in (36, 45, 54, 40, 60)]),
}


@pytest.mark.parametrize("name", STREAMS)
def test_five_are_cut_where_they_are(name: str) -> None:
    assert_at(cuts_of(STREAMS[name]), STREAMS[name].truths)


def test_slow_ones_are_found_as_quick_ones_are() -> None:
    stream = Stream().repeat([moved(eased(5 * RATE_HZ), WAVE)] * 4)
    assert_at(cuts_of(stream, 4), stream.truths, near_s=1.0)


def test_a_webcam_at_half_the_rate_with_jitter_and_lost_joints_is_enough() -> None:
    stream, rng = five_waves(), np.random.default_rng(1)
    frames = [
        skeleton(
            i * FRAME_NS + int(rng.integers(0, FRAME_NS // 2)),
            lacking(joints, "left_foot", *(["right_hand"] if rng.random() < 0.1 else [])),
            seq=i,
        )
        for i, joints in enumerate(stream.joints(noise_m=0.01))
        if i % 2 == 0
    ]
    cuts = cut(seen(frames), 5, 0)
    assert cuts is not None
    assert_at(cuts, stream.truths)


def test_of_several_people_the_one_who_repeats_is_cut() -> None:
    stream = five_waves()
    fidgeting = Stream().then(rest(3)).then(moved(eased(40), SCRATCH)).then(rest(4)).then(walk(4)).then(rest(9))
    frames = together(fidgeting.joints() + np.array([0.8, 0, -0.5]), stream.joints(seed=1))
    cuts = cut(seen(frames), 5, 0)
    assert cuts is not None
    assert cuts.course.agent == 2
    assert_at(cuts, stream.truths)


def test_of_two_who_repeat_the_nearer_one_is_cut() -> None:
    near, far = five_waves(), five_waves()
    cuts = cut(seen(together(far.joints() + np.array([0.9, 0, 1.0]), near.joints(seed=1))), 5, 0)
    assert cuts is not None
    assert cuts.course.agent == 2


def test_two_that_follow_each_other_almost_at_once_are_two() -> None:
    stream = Stream().repeat([ONE_WAVE, np.concatenate([ONE_WAVE, rest(0.1), ONE_WAVE]), ONE_WAVE, ONE_WAVE])
    assert len(cuts_of(stream, asked=None).repetitions) == 5


ONE_LACKS = "5 of 6 repetitions found: record 1 more"
SECOND_JOINED = "the second and third repetition may be joined at 3.3 s"


@pytest.mark.parametrize(
    ("dips", "asked", "doubts"),
    [
        ([50], 6, [f"{ONE_LACKS}; {SECOND_JOINED}"]),
        ([50], None, [SECOND_JOINED]),
        ([], 6, [ONE_LACKS]),
        ([50, 100], 6, [f"{ONE_LACKS}; {SECOND_JOINED}"]),
        ([50, 100], None, [SECOND_JOINED, "the fourth and fifth repetition may be joined at 6.7 s"]),
        ([10], 5, []),
    ],
)
def test_where_one_is_missing_the_place_where_two_may_have_run_together_is_named(
    dips: list[int], asked: int | None, doubts: list[str]
) -> None:
    """The second and the third of five bursts are long enough for two; a stop in the first one parts nothing."""
    activity = np.ones(175)
    activity[dips] = 0.1
    course = Course(1, 0, np.zeros((175, 15, 3)), np.zeros(175), np.zeros(15), 2.0)
    chain = Chain(np.array([[0, 20], [30, 70], [80, 120], [130, 150], [155, 175]]), np.ones(5), 1.0)
    assert [doubt.text for doubt in doubts_of(course, activity, chain, asked, 0)] == doubts


@pytest.mark.parametrize(
    ("likeness", "doubted"), [([0.0], []), ([1.0, 0.0], [2]), ([0.0, 1.0, 1.0], [1]), ([1.0, 1.0], [])]
)
def test_a_repetition_that_is_unlike_the_others_is_doubted_where_there_are_others(
    likeness: list[float], doubted: list[int]
) -> None:
    bursts = np.array([[30 * k, 30 * k + 20] for k in range(len(likeness))])
    course = Course(1, 0, np.zeros((100, 15, 3)), np.zeros(100), np.zeros(15), 2.0)
    doubts = doubts_of(course, np.ones(100), Chain(bursts, np.array(likeness), 1.0), None, 0)
    assert [doubt.repetition for doubt in doubts] == doubted


def test_what_cannot_be_found_is_told() -> None:
    cuts = cuts_of(five_waves(), asked=9)
    assert cuts.sureness <= 0.5
    assert cuts.doubts


def test_times_in_doubts_count_from_the_given_stamp() -> None:
    stream = Stream().repeat([moved(eased(42), WAVE)] * 3).repeat([moved(eased(60), SCRATCH)])
    skeletons = stream.skeletons(first_ns=10**18)
    cuts = cut(seen(skeletons), 4, 10**18)
    assert cuts is not None
    assert any("the fourth repetition (" in doubt and "unlike" in doubt for doubt in cuts.doubts)
    assert all(float(word) < 60 for doubt in cuts.doubts for word in doubt.replace("(", "").split() if "." in word)


def test_where_nobody_moves_nothing_is_cut() -> None:
    assert cut(seen(Stream().then(rest(5)).skeletons()), 5, 0) is None
    assert cut([], 5, 0) is None


def test_who_is_gone_for_long_begins_another_course() -> None:
    frames = five_waves().skeletons()
    late = [frame.model_copy(update={"stamp_ns": frame.stamp_ns + round((BREAK_S + 30) * 1e9)}) for frame in frames]
    later = [frame.model_copy(update={"seq": None}) for frame in late]
    assert len(seen([*frames, *later])) == 2


def analytic(
    durations_s: Sequence[float], rate_hz: float, first_ns: int = 0, mirrored: bool = False
) -> tuple[Course, list[tuple[float, float]]]:
    """Make a course of waves at any rate, without a sensor's noise, and where they lie (s)."""
    starts_s = np.cumsum([1.5, *(duration + 1.5 for duration in durations_s)])[:-1]
    times_s = np.arange(0, starts_s[-1] + durations_s[-1] + 1.5, 1 / rate_hz)
    phase = np.zeros(len(times_s))
    for start_s, duration_s in zip(starts_s, durations_s, strict=True):
        within = (times_s >= start_s) & (times_s <= start_s + duration_s)
        phase[within] = (1 - np.cos(2 * np.pi * (times_s[within] - start_s) / duration_s)) / 2
    joints: Array = moved(phase, WAVE)
    if mirrored:
        joints = joints[:, LEFT_RIGHT] * [-1, 1, 1]
    speeds = np.linalg.norm(np.gradient(joints, 1 / rate_hz, axis=0), axis=2)
    stamps_ns = (first_ns + np.round(times_s * 1e9).astype(np.int64)).tolist()
    spans = [(start, start + duration) for start, duration in zip(starts_s, durations_s, strict=True)]
    return course_of(1, stamps_ns, joints, speeds, 2.0), spans


def spans_s(course: Course, asked: int | None, first_ns: int) -> list[tuple[float, float]]:
    cuts = cut([course], asked, first_ns)
    assert cuts is not None
    return [((each.start_ns - first_ns) / 1e9, (each.end_ns - first_ns) / 1e9) for each in cuts.repetitions]


DURATIONS = st.lists(st.floats(0.9, 2.0), min_size=3, max_size=6)


@settings(max_examples=15)
@given(DURATIONS, st.sampled_from([12.0, 15.0, 25.0, 30.0]), st.integers(0, 2**60), st.booleans())
def test_neither_rate_nor_clock_nor_hand_matters(
    durations_s: list[float], rate_hz: float, first_ns: int, mirrored: bool
) -> None:
    course, truths = analytic(durations_s, rate_hz, first_ns, mirrored)
    found = spans_s(course, len(durations_s), first_ns)
    assert len(found) == len(truths)
    np.testing.assert_allclose(found, truths, atol=0.45)


@settings(max_examples=15)
@given(DURATIONS, st.integers(0, 2**60))
def test_shifted_stamps_shift_the_cuts(durations_s: list[float], shift_ns: int) -> None:
    plain, _ = analytic(durations_s, 30.0)
    shifted, _ = analytic(durations_s, 30.0, shift_ns)
    assert spans_s(plain, None, 0) == spans_s(shifted, None, shift_ns)


@settings(max_examples=10)
@given(st.integers(0, 2**32 - 1), st.integers(20, 200), st.sampled_from([None, 1, 5]))
def test_any_movement_gives_cuts_in_order_that_do_not_overlap(seed: int, frames: int, asked: int | None) -> None:
    joints = np.random.default_rng(seed).normal(0, 0.2, (frames, 15, 3)).cumsum(axis=0)
    speeds = np.linalg.norm(np.gradient(joints, 1 / 15, axis=0), axis=2)
    course = course_of(1, [i * 66_666_667 for i in range(frames)], joints, speeds, 2.0)
    cuts = cut([course], asked, 0)
    if cuts is None:
        return
    bounds = [bound for each in cuts.repetitions for bound in (each.start_ns, each.end_ns)]
    assert bounds == sorted(bounds)
    assert 0 <= cuts.sureness <= 1
    assert asked is None or len(cuts.repetitions) <= asked
