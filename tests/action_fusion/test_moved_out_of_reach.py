"""An object displaced where the hands never were is another's; one thrown or pushed with a tool was acted on."""

import pytest

from fused import event_in, event_of
from scenes import REST_RIGHT, Path, Place, Scene, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
BOOK: Place = (-0.4, 0.0, 0.5)
AT_CUP: Place = (0.1, 0.08, 0.4)
AT_MOUTH: Place = (0.05, 0.6, 0.15)


FAR_OFF = {
    "lifted": moving((0.6, (1.3, 0.0, 0.4)), (1.4, (1.3, 0.25, 0.4))),
    "pushed": moving((0.6, (0.9, 0.0, 0.9)), (1.4, (0.9, 0.0, 1.1))),
    "brought nearer": moving((0.2, (1.5, 0.0, 1.2)), (1.9, (0.8, 0.0, 0.9))),
}
HANDS = {
    "at rest": still(REST_RIGHT),
    "to the mouth": moving((0.3, REST_RIGHT), (1.0, AT_MOUTH), (1.4, AT_MOUTH), (1.9, REST_RIGHT)),
}


@pytest.mark.parametrize("hand", HANDS.values(), ids=HANDS)
@pytest.mark.parametrize("cup", FAR_OFF.values(), ids=FAR_OFF)
@pytest.mark.parametrize("measure", ["joint", "proximity"])
def test_what_another_moves_out_of_reach_is_told_and_not_acted_on(cup: Path, hand: Path, measure: str) -> None:
    scene = Scene(right_hand=hand, objects={1: cup, 2: still((0.0, 0.0, 1.5))})
    event = event_in(scene, action("drink"), measure=measure)
    assert (event.object, event.candidates, event.outcome) == (None, [], None)
    assert event.why == 'no object within reach; another moved object 1 "cup"'
    assert event.sentence == f"drink, {event.why}, 0.94"


def test_what_a_hand_reaches_for_is_acted_on_though_another_moves_a_thing_elsewhere() -> None:
    scene = Scene(right_hand=moving((0.2, REST_RIGHT), (0.9, AT_CUP)), objects={1: still(CUP), 2: FAR_OFF["pushed"]})
    event = event_in(scene, action("touch"))
    assert (event.object and event.object.name, event.why) == ("cup", None)


def test_what_the_other_hand_of_the_same_person_moves_is_not_anothers() -> None:
    left = moving((0.5, (-0.4, 0.08, 0.5)), (1.2, (-0.4, 0.3, 0.5)))
    scene = Scene(left_hand=left, objects={1: moving((0.5, BOOK), (1.2, (-0.4, 0.22, 0.5)))})
    event = event_in(scene, action("act"))
    assert (event.hand, event.object, event.why) == ("right", None, "no object within reach")


def test_what_is_thrown_is_acted_on() -> None:
    thrown = moving((0.8, CUP), (1.1, (0.1, 0.3, 0.6)), (1.3, (0.1, 0.5, 1.6)), (1.5, (0.1, 0.0, 2.6)))
    hand = moving((0.2, REST_RIGHT), (0.8, AT_CUP), (1.1, (0.1, 0.38, 0.55)), (1.6, REST_RIGHT))
    event = event_in(Scene(right_hand=hand, objects={1: thrown, 2: still(BOOK)}), action("throw"))
    assert event.object is not None and event.object.name == "cup"


def test_what_slides_off_unseen_from_under_the_hand_is_acted_on() -> None:
    """Seen at the hand and then, after a gap in which no hand was seen either, two metres away."""
    scene = Scene(
        right_hand=moving((0.2, REST_RIGHT), (0.8, (0.1, 0.15, 0.6)), (1.0, REST_RIGHT)),
        objects={1: lambda t: (0.1, 0.0, 0.7) if t < 1.2 else (0.1, 0.0, 2.7)},
        hidden=lambda number, t: number == 1 and 0.9 < t < 1.5,
    )
    seen = [p for p in scene.postures() if not 0.9e9 < p.stamp_ns - action("x").start_ns < 1.5e9]
    event = event_of(*seen, *scene.sightings(), action("flick"))
    assert event.object is not None and event.object.name == "cup"


def test_what_is_pushed_with_a_tool_that_has_no_marker_is_acted_on() -> None:
    hand = moving((0.2, REST_RIGHT), (0.7, (0.1, 0.05, 0.3)), (1.4, (0.1, 0.05, 0.5)))
    pushed = moving((0.7, (0.1, 0.0, 0.68)), (1.4, (0.1, 0.0, 0.88)))
    event = event_in(Scene(right_hand=hand, objects={1: pushed, 2: still(BOOK)}), action("push"))
    assert (event.object and event.object.name, event.outcome) == ("cup", "pushed")


def test_what_moves_otherwise_than_a_hand_near_it_is_anothers() -> None:
    hand = moving((0.2, REST_RIGHT), (0.7, (0.1, 0.05, 0.3)), (1.4, (0.1, 0.05, 0.15)))
    taken = moving((0.7, (0.1, 0.0, 0.68)), (1.4, (0.1, 0.0, 0.88)))
    assert event_in(Scene(right_hand=hand, objects={1: taken}), action("pull")).object is None


def test_a_far_thing_is_pointed_at_while_another_moves() -> None:
    head, tip = (0.0, 0.75, 0.05), (0.18, 0.62, 0.5)
    far = tuple(h + 4.0 * (t - h) for h, t in zip(head, tip, strict=True))
    elbow = tuple(t - 3.5 * 0.1 * (b - a) / 0.5 for t, a, b in zip(tip, head, tip, strict=True))
    hand = tuple(t + (e - t) * 0.1 / 0.35 for t, e in zip(tip, elbow, strict=True))
    scene = Scene(
        right_hand=still(hand),  # type: ignore[arg-type]
        right_elbow=still(elbow),  # type: ignore[arg-type]
        objects={1: still(far), 2: FAR_OFF["lifted"]},  # type: ignore[dict-item]
    )
    event = event_in(scene, action("point"))
    assert event.object is not None and event.object.name == "cup"
