"""Views are taken from a live stream when the board rests at a new place."""

import numpy as np
import pytest

from actum_calibrator.board import Board
from actum_calibrator.board_views import View
from actum_calibrator.view_collector import ENOUGH_PAIRS, PairCollector, ViewCollector

BOARD = Board()


def view(x: float, y: float, tilt: float = 0.0, width: float = 200.0) -> View:
    """The board at a place (px), narrowed towards its right end by a tilt."""
    plane = BOARD.corners_m[:, :2] / BOARD.width_m
    corners = width * plane / (1 + tilt * plane[:, :1]) * [1 - abs(tilt) / 2, 1] + [x, y]
    return View("", (640, 480), BOARD, list(range(24)), corners, 0.5)


def rest(collector: ViewCollector, seen: View) -> bool:
    collector.offer(seen)
    return collector.offer(seen)


def test_a_resting_board_is_taken_once() -> None:
    collector = ViewCollector()
    assert [collector.offer(view(100, 100)) for _ in range(4)] == [False, True, False, False]


def test_a_moving_board_is_not_taken() -> None:
    collector = ViewCollector()
    assert not any(collector.offer(view(100 + 5 * n, 100)) for n in range(40))


def test_a_board_lost_in_between_has_to_rest_anew() -> None:
    collector = ViewCollector()
    assert [collector.offer(seen) for seen in (view(100, 100), None, view(100, 100), view(100, 100))] == [
        False, False, False, True,
    ]  # fmt: skip


def test_only_what_differs_enough_is_taken() -> None:
    collector = ViewCollector()
    assert rest(collector, view(100, 100))
    assert not rest(collector, view(120, 110))
    assert rest(collector, view(200, 100))


def test_wishes_tell_what_is_missing_until_nothing_is() -> None:
    collector = ViewCollector()
    assert "hold it still" in str(collector.instruction)
    rest(collector, view(100, 100))
    assert "tilt the board" in str(collector.instruction)
    places = [(x, y) for y in (10, 120, 230, 330) for x in (10, 120, 230, 340, 430)]
    instructions = []
    for n, (x, y) in enumerate(places):
        rest(collector, view(x, y, tilt=0.9 * (-1) ** n * (n % 2 or 0.8)))
        instructions.append(str(collector.instruction))
    assert any("bottom" in instruction for instruction in instructions)
    assert collector.instruction is None
    assert collector.complete


def test_tilted_views_are_asked_for_first_until_half_of_ten_are_tilted() -> None:
    places = [(x, y) for y in (20, 250) for x in (10, 120, 230, 340, 430)]
    collector = ViewCollector()
    for tilted in range(11):
        collector.views = [view(*place, tilt=0.9 if n < tilted else 0.0) for n, place in enumerate(places)]
        assert str(collector.instruction).startswith("tilt") == (tilted < 5)


def test_a_pair_is_taken_when_the_board_rests_before_both() -> None:
    collector = PairCollector()
    stream = [(0, view(100, 100)), (1, view(50, 50)), (0, view(100, 100)), (1, view(50, 50))]
    assert [collector.offer(*seen) for seen in stream] == [False, False, False, True]
    assert not collector.offer(0, view(100, 100))


def test_no_pair_mixes_times_before_and_after_a_movement() -> None:
    collector = PairCollector()
    for seen in (view(100, 100), view(100, 100), view(300, 100)):
        collector.offer(0, seen)
    assert not any(collector.offer(1, view(50, 50)) for _ in range(3))


def test_pairs_are_numbered_and_suffice_in_the_end() -> None:
    collector = PairCollector()
    for x in np.arange(ENOUGH_PAIRS) * 70.0:
        for _ in range(2):
            collector.offer(0, view(x, 100))
            collector.offer(1, view(x / 2, 50))
    assert [pair.name for pair in collector.pairs] == [f"pair {n + 1}" for n in range(ENOUGH_PAIRS)]
    assert collector.complete
    assert collector.pairs[3].markers.corners_px[0, 0] == pytest.approx(
        collector.pairs[3].people.corners_px[0, 0] * 2, rel=0.2
    )
