"""The best set of candidates, and what of it is decided as a stream goes on."""

import gc
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from som_classifier.spotting.decoding import Candidate, Decoder, best_set

LAG, LONGEST, OVERLAP = 6, 24, 0.2
STEP = 3
DURATIONS = (5, 10, 17, LONGEST)


def candidate(start: int, end: int, gain: float = 1.0, action: int = 0) -> Candidate:
    return Candidate(start, end, action, 1.0, gain)


@st.composite
def candidates(draw: st.DrawFn) -> list[Candidate]:
    """Up to nine in the order of their ends; their gains add up without rounding."""
    spans = draw(st.lists(st.tuples(st.integers(0, 20), st.integers(0, 8), st.integers(1, 9)), max_size=9))
    return sorted((candidate(start, start + length, gain / 4) for start, length, gain in spans), key=lambda c: c.end_ns)


def is_disjoint(chosen: Sequence[Candidate]) -> bool:
    in_order = sorted(chosen, key=lambda each: each.start_ns)
    return all(a.end_ns < b.start_ns for a, b in pairwise(in_order))


def gain_of(chosen: Sequence[Candidate]) -> float:
    return sum(each.gain for each in chosen)


@given(of=candidates())
def test_no_other_set_without_overlap_is_worth_more(of: list[Candidate]) -> None:
    every = [each for count in range(len(of) + 1) for each in combinations(of, count) if is_disjoint(each)]
    best = best_set(of)
    assert is_disjoint(best) and all(each in of for each in best)
    assert gain_of(best) == max(map(gain_of, every))
    assert best == sorted(best, key=lambda each: each.end_ns)


def test_spans_that_share_one_instant_overlap() -> None:
    assert best_set([candidate(0, 5), candidate(5, 9)]) == [candidate(0, 5)]
    assert best_set([candidate(0, 5), candidate(6, 9)]) == [candidate(0, 5), candidate(6, 9)]


def test_of_equal_sets_the_earliest_is_best() -> None:
    assert best_set([candidate(0, 5, action=1), candidate(0, 5, action=2), candidate(3, 8)]) == [
        candidate(0, 5, action=1)
    ]


def test_two_that_follow_each_other_win_over_one_across_both_that_is_worth_less_than_their_sum() -> None:
    two = [candidate(0, 4, 1.0), candidate(5, 9, 1.0)]
    assert best_set([two[0], candidate(1, 8, 1.9), two[1]]) == two
    assert best_set([two[0], candidate(1, 8, 2.1), two[1]]) == [candidate(1, 8, 2.1)]


def test_nothing_has_no_best() -> None:
    assert best_set([]) == []


def decoder() -> Decoder:
    return Decoder(LAG, LONGEST + LAG, OVERLAP)


def live(seed: int, steps: int, density: float = 0.5) -> Iterator[tuple[int, list[Candidate]]]:
    """A stream's decisions: at each, some windows that end then are candidates."""
    rng = np.random.default_rng(seed)
    now = 100
    for _ in range(steps):
        now += int(rng.integers(1, STEP + 1))
        yield now, [candidate(now - d, now, float(rng.exponential())) for d in DURATIONS if rng.random() < density]


def decided(of: Decoder, stream: Iterator[tuple[int, list[Candidate]]]) -> list[tuple[int, Candidate]]:
    return [(now, each) for now, offered in stream for each in of.step(now, offered)]


@given(seed=st.integers(0, 10**6), density=st.floats(0.05, 1.0))
def test_what_is_decided_comes_in_order_overlaps_nothing_and_was_offered(seed: int, density: float) -> None:
    offered = {(c.end_ns, c.gain): c for _, of_now in live(seed, 60, density) for c in of_now}
    found = decided(decoder(), live(seed, 60, density))
    segments = [each for _, each in found]
    assert is_disjoint(segments) and segments == sorted(segments, key=lambda each: each.start_ns)
    for each in segments:
        whole = offered[each.end_ns, each.gain]
        assert whole.start_ns <= each.start_ns < each.end_ns
        assert each.start_ns - whole.start_ns <= OVERLAP * (whole.end_ns - whole.start_ns) + 1


@given(seed=st.integers(0, 10**6))
def test_nothing_is_decided_before_its_lag_is_over_nor_much_after_it(seed: int) -> None:
    """It waits on while another that overlaps it is worth more: no longer than that one may last."""
    for now, each in decided(decoder(), live(seed, 60)):
        assert LAG <= now - each.end_ns <= LONGEST + LAG + STEP


@given(seed=st.integers(0, 10**6), length=st.integers(0, 60))
def test_a_prefix_is_decided_as_in_the_whole(seed: int, length: int) -> None:
    whole, begun = decided(decoder(), live(seed, 60)), decided(decoder(), live(seed, length))
    assert whole[: len(begun)] == begun


def test_a_lone_candidate_is_decided_once_with_the_first_step_after_its_lag() -> None:
    of, lone = decoder(), candidate(80, 100)
    assert of.step(100, [lone]) == of.step(100 + LAG - 1, []) == []
    assert of.step(100 + LAG, []) == [lone]
    assert of.step(100 + LAG + 1, []) == []


@pytest.mark.parametrize(("start", "cut"), [(98, 101), (96, 101), (95, None)])
def test_the_next_may_reach_into_the_one_before_by_a_share_of_its_length_which_is_cut_off(
    start: int, cut: int | None
) -> None:
    """A fifth of its 20: from 96 to 100, and from 95 on it is more."""
    of = decoder()
    assert of.step(100 + LAG, [candidate(80, 100)]) == [candidate(80, 100)]
    end = start + 20
    found = of.step(end, [candidate(start, end)]) + of.step(end + LAG, [])
    assert [each.start_ns for each in found] == ([] if cut is None else [cut])


def test_what_ends_within_the_one_decided_is_never_decided() -> None:
    of = decoder()
    of.step(100 + LAG, [candidate(80, 100)])
    assert not of.is_free(99, 100) and of.is_free(101, 102)


def test_after_forgetting_nothing_from_before_is_decided() -> None:
    of = decoder()
    assert of.step(100, [candidate(80, 100)]) == []
    of.forget()
    assert of.step(100 + LAG, []) == []


@pytest.mark.long
def test_however_long_a_stream_few_candidates_are_kept() -> None:
    """No more than can end within the time that a window lasts and its decision waits."""
    of, before, most = decoder(), kept(), 0
    for now, offered in live(seed=1, steps=4_000, density=1.0):
        of.step(now, offered)
        if now % 500 < STEP:
            most = max(most, kept() - before)
    assert 0 < most <= len(DURATIONS) * (LONGEST + LAG + 2)


def kept() -> int:
    return sum(isinstance(each, Candidate) for each in gc.get_objects())
