"""Closeness, the reach's heading and co-motion decide the object over the whole segment, not one frame."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fused
from action_fusion.choice import cues
from action_fusion.choice.evidence import Choice, Evidence
from actum.messages import Event, Hand
from fused import event_in
from scenes import REST_LEFT, REST_RIGHT, Path, Place, Scene, acting_on, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
BESIDE: Place = (0.1, 0.0, 0.6)


def event_of(
    scene: Scene,
    label: str = "act",
    start_s: float = 0.0,
    end_s: float = 2.0,
    marked: Hand | None = None,
    **chosen: object,
) -> Event:
    return event_in(scene, action(label, start_s, end_s, hand=marked), **chosen)


def names(event: Event) -> tuple[str | None, str | None]:
    return event.object and event.object.name, event.held and event.held.name


def around(path: Path, radius_m: float, hertz: float, start_s: float = 0.0) -> Path:
    """Circle about a path's place in the plane of the table."""

    def circling(t: float) -> Place:
        right, up, forward = path(t)
        turn = 2 * np.pi * hertz * (t - start_s)
        share = 1.0 if t > start_s else 0.0
        return right + share * radius_m * np.sin(turn), up, forward + share * radius_m * np.cos(turn)

    return circling


def beyond(path: Path, offset: Place) -> Path:
    return lambda t: tuple(np.add(path(t), offset).tolist())  # type: ignore[return-value]


def test_what_moves_with_the_hand_is_acted_on_though_another_thing_is_nearer() -> None:
    hand = moving((0.8, (0.1, 0.1, 0.45)), (1.6, (0.1, 0.1, 0.6)))
    scene = Scene(
        right_hand=moving((0.0, REST_RIGHT), (0.8, hand(0.8)), (1.6, hand(1.6))),
        objects={1: beyond(hand, (0.0, -0.12, 0.0)), 2: still((0.1, 0.1, 0.62))},
    )
    assert names(event_of(scene, "push")) == ("cup", "cup")
    plain = event_of(scene, "push", measure="proximity")
    assert names(plain) == ("box", None)


def test_an_object_that_another_hand_transports_past_is_not_this_hands() -> None:
    left = moving((0.3, (-0.3, 0.1, 0.5)), (1.0, (0.0, 0.1, 0.5)), (1.7, (-0.3, 0.1, 0.5)))
    scene = Scene(
        right_hand=still((0.1, 0.1, 0.5)),
        left_hand=left,
        objects={1: still((0.1, -0.05, 0.5)), 2: beyond(left, (0.06, 0.0, 0.0))},
    )
    event = event_of(scene)
    assert event.distances_m["2"] < event.distances_m["1"]
    assert names(event) == ("cup", None)


def test_a_reach_past_one_thing_to_another_is_for_the_one_it_heads_at() -> None:
    target, passed = (0.0, 0.0, 0.7), (-0.13, 0.0, 0.54)
    scene = Scene(
        right_hand=moving((0.5, (0.0, 0.0, 0.2)), (1.5, (0.0, 0.0, 0.54))),
        objects={1: still(target), 2: still(passed)},
    )
    assert names(event_of(scene, end_s=1.7)) == ("cup", None)
    assert names(event_of(scene, end_s=1.7, measure="proximity")) == ("box", None)


def test_a_hand_that_stays_beside_things_it_never_reached_for_acts_on_none() -> None:
    scene = Scene(right_hand=still((0.0, 0.0, 0.4)), objects={1: still((0.0, 0.0, 0.62)), 2: still((0.23, 0.0, 0.4))})
    event = event_of(scene)
    assert (event.object, event.why) == (None, "no object within reach was acted on")
    assert event.sentence == "act, no object within reach was acted on, 0.94"


def test_a_hold_is_told_by_the_reach_that_came_before_it() -> None:
    scene = Scene(
        right_hand=moving((-0.9, (0.0, 0.0, 0.2)), (-0.2, (0.0, 0.0, 0.54))),
        objects={1: still((0.0, 0.0, 0.7)), 2: still((-0.14, 0.0, 0.54))},
    )
    assert names(event_of(scene)) == ("cup", None)


def test_of_two_things_as_likely_both_are_named() -> None:
    scene = Scene(
        right_hand=moving((0.3, (0.0, 0.0, 0.2)), (1.0, (0.0, 0.0, 0.5))),
        objects={1: still((-0.05, 0.0, 0.6)), 2: still((0.05, 0.0, 0.601)), 3: still((0.3, 0.0, 0.6))},
    )
    event = event_of(scene, "touch")
    assert [candidate.name for candidate in event.candidates] == ["cup", "box"]
    assert event.sentence == 'touch object 1 "cup" or object 2 "box", unmoved, 0.94'


def test_of_two_things_as_likely_the_one_that_gave_way_was_touched() -> None:
    nudged = moving((1.0, (0.05, 0.0, 0.601)), (1.2, (0.05, 0.0, 0.609)))
    scene = Scene(
        right_hand=moving((0.3, (0.0, 0.0, 0.2)), (1.0, (0.0, 0.0, 0.5))),
        objects={1: still((-0.05, 0.0, 0.6)), 2: nudged},
    )
    event = event_of(scene, "touch")
    assert (event.object and event.object.name, event.candidates) == ("box", [])


def working(radius_m: float = 0.03) -> Scene:
    """The hand holds the box and circles with it above the cup; before the segment it lifted it from elsewhere."""
    way = moving((-0.8, (0.3, 0.0, 0.4)), (-0.1, (0.1, 0.12, 0.45)))
    tool = around(way, radius_m, hertz=1.5)
    return Scene(
        right_hand=beyond(tool, (0.0, 0.08, 0.0)),
        objects={1: still(CUP), 2: tool, 3: still((-0.2, 0.0, 0.5))},
    )


def test_what_a_held_tool_is_used_on_is_acted_on() -> None:
    event = event_of(working(), "stir")
    assert names(event) == ("cup", "box")
    assert event.sentence == 'stir object 1 "cup" with object 2 "box", unmoved, 0.94'


def test_an_action_that_is_to_move_its_object_uses_no_tool() -> None:
    assert names(event_of(working(), "push")) == ("box", "box")
    assert names(event_of(working(), "stir", expected_outcomes={"stir": "moved"})) == ("box", "box")


def test_an_object_transported_past_another_is_not_used_on_it() -> None:
    hand = moving((0.2, (0.1, 0.1, 0.3)), (1.8, (0.1, 0.1, 0.65)))
    scene = Scene(right_hand=hand, objects={1: beyond(hand, (0.0, -0.08, 0.0)), 2: still((0.2, 0.0, 0.5))})
    assert names(event_of(scene)) == ("cup", "cup")


@settings(max_examples=15)
@given(st.integers(0, 10**6), st.sampled_from([(0.1, 0.15, 0.45), (0.1, 0.0, 0.65), (-0.1, 0.0, 0.45)]))
def test_neither_noise_nor_lost_sightings_make_another_object_of_it(seed: int, then: Place) -> None:
    """A centimetre of noise in each joint, three millimetres in each marker, a third of the sightings lost."""
    rng = np.random.default_rng(seed)
    scene = acting_on(CUP, then, others={2: (0.2, 0.0, 0.45), 3: (0.1, 0.0, 0.3)})

    def shaken(place: list[float], sd_m: float) -> list[float]:
        return np.add(place, rng.normal(0.0, sd_m, 3)).tolist()

    postures = [
        p.model_copy(update={"joints_m": [None if j is None else shaken(j, 0.01) for j in p.joints_m or []]})
        for p in scene.postures()
    ]
    sightings = [
        m.model_copy(
            update={
                "objects": [
                    o.model_copy(update={"position_m": shaken(o.position_m, 0.003), "seen": rng.random() > 1 / 3})
                    for o in m.objects
                ]
            }
        )
        for m in scene.sightings()
    ]
    event = fused.event_of(*postures, *sightings, action("push"))
    assert event.object is not None and event.object.id == 1


@pytest.mark.parametrize("measure", ["joint", "proximity"])
def test_a_hand_seen_once_is_enough_to_be_near(measure: str) -> None:
    scene = acting_on(CUP, CUP)
    once = [p for p in scene.postures() if p.stamp_ns > action("x").start_ns + 1.9e9][:1]
    event = fused.event_of(*once, *scene.sightings(), scene.posture(3.0), action("touch"), measure=measure)
    assert event.object is not None


LEFT_BRINGS = moving((0.5, (-0.3, 0.08, 0.45)), (1.2, (0.0, 0.18, 0.5)), (1.5, (0.0, 0.18, 0.5)), (2.2, REST_LEFT))
RIGHT_TAKES = moving((0.9, REST_RIGHT), (1.3, (0.06, 0.1, 0.5)), (1.5, (0.06, 0.1, 0.5)), (2.3, (0.35, 0.08, 0.5)))
HANDED_OVER = moving((0.5, (-0.3, 0.0, 0.45)), (1.2, (0.0, 0.1, 0.5)), (1.5, (0.0, 0.1, 0.5)), (2.3, (0.29, 0.08, 0.5)))


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("covered", [False, True])
def test_both_hands_acted_on_what_one_gave_to_the_other(hand, covered) -> None:
    scene = Scene(
        left_hand=LEFT_BRINGS,
        right_hand=RIGHT_TAKES,
        objects={1: HANDED_OVER, 2: still((0.4, 0.0, 0.3))},
        hidden=lambda number, t: covered and number == 1 and 0.6 < t < 2.2,
    )
    event = event_of(scene, "give", end_s=2.5, marked=hand)
    assert (names(event), event.hand) == (("cup", "cup"), hand)


BOTH_LIFT = Scene(
    left_hand=moving((0.0, REST_LEFT), (0.6, (0.0, 0.02, 0.45)), (1.6, (0.0, 0.26, 0.45))),
    right_hand=moving((0.0, REST_RIGHT), (0.6, (0.2, 0.02, 0.45)), (1.6, (0.2, 0.27, 0.45))),
    objects={1: moving((0.6, CUP), (1.6, (0.1, 0.25, 0.45)))},
)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_what_both_hands_lift_is_lifted_by_either(hand) -> None:
    event = event_of(BOTH_LIFT, "lift", marked=hand)
    assert (names(event), event.hand, event.outcome) == (("cup", "cup"), hand, "lifted")


@pytest.mark.parametrize("part", [None, "right_arm"])
def test_a_cue_listed_first_decides_and_may_name_both_hands(monkeypatch, part) -> None:
    def between_both(evidence: Evidence) -> Choice:
        lifting = [pair for pair in evidence.transporting if pair.hand in evidence.hands.own.values()]
        return Choice(lifting[0].track, tuple(pair.hand.side for pair in lifting), lifting[0].track)

    monkeypatch.setattr(cues, "CUES", {"joint": (between_both, *cues.CUES["joint"])})
    event = event_in(BOTH_LIFT, action("lift", part=part))
    assert event.object is not None
    assert (names(event), event.hand, event.object.in_hand_at_end) == (("cup", "cup"), None, True)


def test_a_reach_that_ends_at_a_large_things_rim_is_for_it() -> None:
    """Its middle is further away than a grasp; the way there passes within half of a thing of two decimetres."""
    scene = Scene(
        right_hand=moving((0.3, (0.1, 0.05, 0.0)), (1.0, (0.1, 0.05, 0.25))),
        objects={1: still((0.12, 0.0, 0.47)), 2: still((-0.3, 0.0, 0.3))},
    )
    event = event_of(scene, "hold")
    assert 0.2 < event.distances_m["1"] < 0.25
    assert names(event) == ("cup", None)


def test_a_reach_past_a_things_rim_is_not_for_it() -> None:
    scene = Scene(
        right_hand=moving((0.3, (-0.05, 0.05, 0.0)), (1.0, (-0.05, 0.05, 0.31))),
        objects={1: still((0.12, 0.0, 0.45))},
    )
    event = event_of(scene, "hold")
    assert 0.2 < event.distances_m["1"] < 0.25
    assert names(event) == (None, None)
