"""The network of contacts is measured on people from whom it has not learnt, and on reaches among boxes."""

import numpy as np
import pytest
from benchmarks.intent.boxes import CHOSEN, GUESSES, mcnemar_p
from benchmarks.intent.cad120 import Reach
from benchmarks.intent.takes import simulated

from action_fusion.intent.contact_network import shipped_network
from actum.node import SECOND_NS
from actum_model_trainer.foreseeing.said import said_by
from actum_model_trainer.foreseeing.scoring import ahead, before


def test_the_network_that_comes_with_actum_foresees_contacts_of_people_it_has_not_seen() -> None:
    said = [said_by(shipped_network(), take) for take in simulated([201], 9)]
    assert before(said, 0.5).right >= 0.8
    assert ahead(said, 0.8).median_s >= 0.3


def test_an_object_that_a_hand_reaches_for_is_found_although_nobody_knows_how_far_away_it_is() -> None:
    reach = reach_for_the_nearer()
    assert GUESSES[CHOSEN].is_right(reach, 0.8)
    assert not GUESSES["actum, as far as the hands"].is_right(reach, 0.8)


def test_an_object_may_be_anywhere_within_a_metre_of_the_shoulders() -> None:
    reach = reach_for_the_nearer()
    places_m = np.array([path_m[0] for _, path_m in sorted(reach.anywhere().objects_m.items())])
    assert np.linalg.norm(places_m - reach.arms_m[0, 4:].mean(axis=0), axis=1).max() == pytest.approx(1.0)
    rays = places_m / places_m[:, 2:]
    assert rays == pytest.approx(np.repeat(reach.rays, len(rays) // len(reach.rays), axis=0))


def test_two_methods_differ_if_one_alone_is_right_more_often_than_a_coin_shows_heads() -> None:
    assert mcnemar_p(3, 3) == 1.0
    assert mcnemar_p(5, 0) == mcnemar_p(0, 5) == pytest.approx(2 / 2**5)


def reach_for_the_nearer() -> Reach:
    """Return a reach towards the camera, for an object half a metre before the hands; another is as far as they are."""
    share = np.linspace(0, 1, 21)[:, None]
    start_m, target_m, other_m = np.array([0.15, 0.2, 2.0]), np.array([-0.05, 0.25, 1.5]), np.array([-0.15, 0.25, 2.0])
    body_m = np.array(
        [[0.15, 0.2, 2.0], [-0.3, 0.2, 2.0], [0.3, 0.0, 2.2], [-0.3, 0.0, 2.2], [0.2, -0.3, 2.3], [-0.2, -0.3, 2.3]]
    )
    arms_m = np.tile(body_m, (len(share), 1, 1))
    arms_m[:, 0] = start_m + share**3 * (10 - 15 * share + 6 * share**2) * (target_m - start_m)
    stamps_ns = (share[:, 0] * SECOND_NS).astype(np.int64)
    rays = np.array([each_m / each_m[2] for each_m in (target_m, other_m)])
    return Reach("reach", stamps_ns, arms_m, rays, 0)
