"""How often a person has moved objects lately raises what is foreseen; only what moves in a hand counts."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from action_fusion.intake.stream_samples import ObjectsSample
from action_fusion.intent.approach import approach
from action_fusion.intent.contact_network import shipped_network
from action_fusion.intent.recent_beginnings import (
    ASSUMED,
    LATELY_NS,
    MOST_BEGINNINGS,
    RESTED_NS,
    RecentBeginnings,
)
from action_fusion.intent.recent_paths import ARMS, RecentArms, RecentObjects
from actum.node import SECOND_NS
from scenes import FRAME_NS


def counts(*moved: Sequence[int], every_ns: int = FRAME_NS) -> list[float]:
    """Count what is moved from frame to frame, beside what is assumed at first."""
    beginnings = RecentBeginnings()
    counted = [beginnings.with_moved(frame * every_ns, numbers) for frame, numbers in enumerate(moved)]
    return [each - ASSUMED * math.exp(-frame * every_ns / LATELY_NS) for frame, each in enumerate(counted)]


def test_somebody_who_has_just_come_into_view_counts_as_between_acting_and_not_acting() -> None:
    assert RecentBeginnings().with_moved(SECOND_NS, []) == ASSUMED


def test_an_object_that_is_moved_on_and_on_has_begun_to_move_once() -> None:
    assert counts([1], [1], [1])[-1] == pytest.approx(1.0, abs=0.01)
    assert counts([1], [1, 2], [1, 2])[-1] == pytest.approx(2.0, abs=0.02)


def test_an_object_that_moves_after_a_rest_has_begun_anew() -> None:
    assert counts([1], [1], every_ns=RESTED_NS)[-1] == pytest.approx(1 + math.exp(-RESTED_NS / LATELY_NS))
    assert counts([1], [1], every_ns=RESTED_NS - 1)[-1] < 1


def test_a_beginning_counts_the_less_the_longer_ago_it_was() -> None:
    assert counts([1], [], every_ns=LATELY_NS)[-1] == pytest.approx(1 / math.e)


def test_no_more_beginnings_are_kept_than_a_person_can_make() -> None:
    assert RecentBeginnings().with_moved(SECOND_NS, range(10 * MOST_BEGINNINGS)) == MOST_BEGINNINGS


@pytest.mark.parametrize(("apart_m", "moved"), [(0.1, [1]), (0.3, [])], ids=["in a hand", "away from the hands"])
def test_only_what_moves_in_a_hand_has_been_moved(apart_m: float, moved: list[int]) -> None:
    """Both objects are as near to the hands; one of them moves at 0.3 m/s, and the hands with it."""
    arms, objects = RecentArms(), RecentObjects()
    for frame in range(30):
        stamp_ns = frame * FRAME_NS
        way = np.array([0.0, 0.0, 0.3 * stamp_ns / SECOND_NS])
        places = {1: np.array([apart_m, 0.0, way[2]]), 2: np.array([apart_m, 0.0, 0.27])}
        objects.append(ObjectsSample(stamp_ns, "", places, {1: "cup", 2: "box"}, frozenset(), {}))
        arms.append(stamp_ns, np.tile(way, (len(ARMS), 1)))
        seen = approach(arms, objects, stamp_ns)
    assert seen.moved == moved


def test_an_unknown_hand_moves_nothing() -> None:
    arms, objects = RecentArms(), RecentObjects()
    for frame in range(30):
        place = {1: np.array([0.0, 0.0, 0.02 * frame])}
        objects.append(ObjectsSample(frame * FRAME_NS, "", place, {1: "cup"}, frozenset(), {}))
        arms.append(frame * FRAME_NS, np.full((len(ARMS), 3), np.nan))
    assert approach(arms, objects, 29 * FRAME_NS).moved == []


def test_of_the_same_approach_a_contact_is_likelier_while_somebody_moves_objects() -> None:
    network = shipped_network()
    features = network.mean + 0.5 * network.sd * np.random.default_rng(1).normal(size=(2, 3, len(network.mean)))
    calm, busy = (network.foresee(features, begun).probability for begun in (0.0, 3.0))
    assert (busy > calm).all()
