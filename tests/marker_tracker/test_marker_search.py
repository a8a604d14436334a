"""What is still in its place is not searched for; what is new, gone or moved is told at once or soon."""

import numpy as np
import pytest

from actum.node import SECOND_NS
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import ObjectSpec, Settings

CUP, BOX, OTHER = (-0.3, 0.0, 1.2), (0.2, 0.1, 1.2), (0.2, -0.2, 1.2)
FAST_NS, SLOW_NS = SECOND_NS // 60, SECOND_NS // 15


@pytest.fixture
def seen(image_of, pose_at):
    """Show one image after the other; each is a list of (id, place), and is answered by what is seen where."""

    def watch(*images, every_ns=FAST_NS, ids=(3, 5)):
        objects = {number: ObjectSpec(name=f"o{number}", size_m=0.12) for number in ids}
        tracker = MarkerTracker(Settings(objects=objects))
        answers = []
        for i, markers in enumerate(images):
            shown = [(number, 0.12, pose_at(place)) for number, place in markers]
            (answer,) = tracker.handle(image_of(shown, stamp_ns=i * every_ns))
            answers.append({found.id: found.position_m for found in answer.objects if found.seen})
        return answers, tracker.counters

    return watch


def test_what_is_taken_away_is_not_seen_in_the_next_image(seen) -> None:
    answers, _ = seen(*[[(3, CUP), (5, BOX)]] * 3, [(3, CUP)])
    assert [*answers[3]] == [3]


def test_what_moves_is_seen_where_it_went(seen) -> None:
    answers, _ = seen(*[[(3, CUP), (5, BOX)]] * 3, [(3, CUP), (5, OTHER)], [(3, CUP), (5, OTHER)])
    assert np.allclose(answers[4][5], OTHER, atol=0.01)


def test_another_marker_in_the_same_place_is_no_longer_the_one_before(seen) -> None:
    answers, _ = seen(*[[(3, CUP)]] * 2, [(5, CUP)], ids=(3, 5))
    assert [*answers[2]] == [5]


def test_what_comes_is_seen_within_a_twentieth_of_a_second(seen) -> None:
    answers, _ = seen([(3, CUP)], *[[(3, CUP), (5, BOX)]] * 4)
    assert [*answers[4]] == [3, 5]


def test_what_comes_before_a_slow_camera_is_seen_at_once(seen) -> None:
    answers, _ = seen([(3, CUP)], [(3, CUP), (5, BOX)], every_ns=SLOW_NS)
    assert [*answers[1]] == [3, 5]


def test_an_unknown_marker_is_told_soon_though_nothing_is_missing(seen) -> None:
    _, counters = seen([(3, CUP), (5, BOX)], *[[(3, CUP), (5, BOX), (7, OTHER)]] * 6, every_ns=SLOW_NS)
    assert counters.rejects["unknown_marker"] > 0
