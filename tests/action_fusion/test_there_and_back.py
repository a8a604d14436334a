"""What became of an object is judged at its turn: a hand or an object that is back by the end changes nothing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from action_fusion.tracks.object_tracks import ObjectTrack
from actum.messages import Event
from fused import event_in
from scenes import REST_RIGHT, Path, Place, Scene, action, at, moving, still

CUP: Place = (0.1, 0.0, 0.45)
LIFTED: Place = (0.1, 0.2, 0.45)
PUSHED: Place = (0.1, 0.0, 0.66)
PULLED: Place = (0.1, 0.0, 0.25)
BACK_S = 3.0
"""When hand and object rest again."""


def above(place: Place) -> Place:
    return place[0], place[1] + 0.08, place[2]


def there_and_back(then: Place, at_last: Place = CUP) -> Scene:
    """Let the right hand move the cup until 1.6 s, bring it elsewhere or back until 2.4 s, and return to rest."""
    return Scene(
        right_hand=moving(
            (0.0, REST_RIGHT), (0.8, above(CUP)), (1.4, above(then)), (1.6, above(then)), (2.4, above(at_last)),
            (BACK_S, REST_RIGHT),
        ),
        objects={1: moving((0.8, CUP), (1.4, then), (1.6, then), (2.4, at_last)), 2: still((-0.25, 0.0, 0.5))},
    )  # fmt: skip


def left_there(then: Place) -> Scene:
    """Let the right hand move the cup until 1.6 s, and return to rest alone."""
    return Scene(
        right_hand=moving(
            (0.0, REST_RIGHT), (0.8, above(CUP)), (1.4, above(then)), (1.8, above(then)), (BACK_S, REST_RIGHT)
        ),
        objects={1: moving((0.8, CUP), (1.4, then)), 2: still((-0.25, 0.0, 0.5))},
    )


def event_of(scene: Scene, label: str, end_s: float = BACK_S, start_s: float = 0.0, **chosen: object) -> Event:
    return event_in(scene, action(label, start_s, end_s), **chosen)


@pytest.mark.parametrize(
    ("label", "then", "outcome"), [("lift", LIFTED, "lifted"), ("push", PUSHED, "pushed"), ("pull", PULLED, "pulled")]
)
def test_an_object_that_is_brought_back_in_the_segment_is_judged_where_it_was_brought_first(
    label: str, then: Place, outcome: str
) -> None:
    event = event_of(there_and_back(then), label)
    assert event.object is not None and event.motion is not None
    assert (event.object.id, event.outcome, event.agrees) == (1, outcome, True)
    assert np.allclose(event.motion.displacement_m, np.subtract(then, CUP), atol=0.005)


def test_the_event_says_when_it_turned_back_and_that_it_stands_where_it_stood() -> None:
    scene = there_and_back(LIFTED)
    event = event_of(scene, "lift")
    assert event.object is not None and event.object.pose is not None and event.motion is not None
    assert event.motion.turn_ns is not None and at(1.35) <= event.motion.turn_ns <= at(1.65)
    assert np.allclose(event.object.pose.position_m, scene.stance.camera(CUP), atol=1e-6)
    assert (event.object.taken_along, event.object.in_hand_at_end) == (True, False)


@pytest.mark.parametrize("then", [LIFTED, PUSHED])
def test_what_stays_where_it_was_brought_has_no_turn(then: Place) -> None:
    event = event_of(left_there(then), "move")
    assert event.motion is not None
    assert event.motion.turn_ns is None
    assert np.allclose(event.motion.displacement_m, np.subtract(then, CUP), atol=1e-6)


@pytest.mark.parametrize(
    ("at_last", "outcome"),
    [((0.16, 0.0, 0.45), "lifted"), ((0.4, 0.0, 0.45), "moved")],
    ids=["set down beside its place", "carried on"],
)
def test_it_came_back_if_it_ends_nearer_to_its_place_than_to_the_turn(at_last: Place, outcome: str) -> None:
    assert event_of(there_and_back(LIFTED, at_last), "lift").outcome == outcome


@settings(max_examples=12, deadline=None)
@given(
    st.sampled_from([there_and_back(LIFTED), there_and_back(PULLED), left_there(PUSHED)]),
    st.floats(0.0, 0.8),
    st.floats(0.0, 0.4),
)
def test_bounds_that_reach_further_into_the_rest_change_nothing(scene: Scene, early_s: float, late_s: float) -> None:
    usual = event_of(scene, "move")
    wider = event_of(scene, "move", BACK_S + late_s, -early_s)
    assert usual.motion is not None and usual.object is not None
    assert wider.motion is not None and wider.object is not None
    seen_last = {"last_seen_ns": usual.object.last_seen_ns}
    assert wider.object.model_copy(update=seen_last) == usual.object
    assert (wider.outcome, wider.result) == (usual.outcome, usual.result)
    assert np.allclose(wider.motion.displacement_m, usual.motion.displacement_m, atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("std_m", [0.002, 0.008])
def test_noise_makes_no_turn_of_a_cup_that_is_only_touched(std_m: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    noisy: Path = lambda _: tuple(np.add(CUP, rng.normal(0, std_m, 3)).tolist())  # noqa: E731
    scene = replace(there_and_back(CUP), objects={1: noisy})
    event = event_of(scene, "touch")
    assert event.object is not None and event.motion is not None
    assert (event.outcome, event.motion.turn_ns) == ("unmoved", None)


def test_one_false_sighting_makes_no_turn() -> None:
    strays: Path = lambda t: LIFTED if abs(t - 1.5) < 0.017 else CUP  # noqa: E731
    event = event_of(replace(there_and_back(CUP), objects={1: strays}), "touch")
    assert event.outcome == "unmoved"


def test_a_thing_pointed_at_is_found_though_the_arm_is_back_by_the_end() -> None:
    thing, other = (0.5, 0.3, 1.4), (0.2, -0.1, 0.8)
    out: Place = (0.32, 0.52, 0.55)
    arm = moving((0.0, REST_RIGHT), (0.9, out), (1.6, out), (2.4, REST_RIGHT))
    scene = Scene(right_hand=arm, right_elbow=still((0.22, 0.45, 0.25)), objects={1: still(thing), 2: still(other)})
    marked = event_of(scene, "point", 1.6)
    for start_s, end_s in ((0.0, BACK_S), (-0.8, BACK_S)):
        event = event_of(scene, "point", end_s, start_s)
        assert marked.object is not None and event.object is not None
        assert (marked.object.id, event.object.id, event.outcome) == (1, 1, "unmoved")


def test_a_covered_cup_stays_where_a_hand_that_went_home_stopped_last() -> None:
    covered = replace(left_there(PUSHED), hidden=lambda number, t: number == 1 and t > 0.75)
    event = event_of(covered, "push", 3.4)
    assert event.object is not None and event.motion is not None
    assert (event.outcome, event.object.in_hand_at_end) == ("pushed", False)
    assert np.allclose(event.motion.displacement_m, np.subtract(PUSHED, CUP), atol=0.03)


def test_a_covered_cup_that_a_hand_fetches_comes_home_with_it() -> None:
    fetching = moving((0.0, REST_RIGHT), (0.8, above(CUP)), (1.2, above(CUP)), (2.0, REST_RIGHT))
    scene = Scene(right_hand=fetching, objects={1: still(CUP)}, hidden=lambda number, t: t > 0.75)
    event = event_of(scene, "fetch")
    assert event.object is not None
    assert (event.object.taken_along, event.object.in_hand_at_end) == (True, True)


@pytest.mark.parametrize("positions_m", [[CUP], [CUP, LIFTED, CUP]])
def test_too_few_positions_have_no_turn(positions_m: list[Place]) -> None:
    stamps_ns = np.arange(len(positions_m), dtype=float)
    track = ObjectTrack(1, "cup", stamps_ns, np.array(positions_m), np.ones(len(positions_m), dtype=bool))
    assert track.turn(0.03) is None
