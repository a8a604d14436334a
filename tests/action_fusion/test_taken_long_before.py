"""A hand has what it took seconds before the segment, and is at what it reached for then, if nothing came between."""

import pytest

import fused
from actum.messages import Event, Message
from scenes import REST_LEFT, REST_RIGHT, Path, Place, Scene, action, at, moving, still

CUP: Place = (0.1, 0.0, 0.45)
TAKEN_FROM: Place = (0.4, 0.0, 0.4)
ABOVE_CUP: Place = (0.1, 0.12, 0.45)


def event_of(scene: Scene, since_s: float = -8.0, without: tuple[float, float] = (0.0, 0.0)) -> Event:
    """Answer a segment of which the streams begin long before; nothing comes `without`, from one time to another."""
    streams: list[Message] = [*scene.postures(start_s=since_s), *scene.sightings(start_s=since_s)]
    heard = [m for m in streams if not at(without[0]) < (m.stamp_ns or 0) < at(without[1])]
    return fused.event_of(*heard, action("act"))


def over(path: Path) -> Path:
    return lambda t: (path(t)[0], path(t)[1] + 0.06, path(t)[2])


BROUGHT = moving((-6.0, TAKEN_FROM), (-5.2, ABOVE_CUP))
HELD_STILL = Scene(right_hand=over(BROUGHT), objects={1: still(CUP), 2: BROUGHT})


def test_what_was_brought_long_before_and_is_held_still_is_a_tool_in_the_hand() -> None:
    event = event_of(HELD_STILL)
    assert (event.object and event.object.name, event.held and event.held.name) == ("cup", "box")


@pytest.mark.parametrize("gap", [(-4.0, -3.0), (-1.5, -0.5), (-1.0, 0.05)])
def test_what_was_before_a_gap_may_be_another_recording(gap: tuple[float, float]) -> None:
    assert event_of(HELD_STILL, without=gap).held is None


def test_what_was_laid_down_long_before_is_not_in_the_hand() -> None:
    """The hand rests beside what it has let go of: it went away, and came back."""
    laid = moving((-6.0, TAKEN_FROM), (-5.2, ABOVE_CUP))
    hand = moving((-6.0, over(laid)(-6.0)), (-5.2, over(laid)(-5.2)), (-4.5, REST_RIGHT), (-3.5, over(laid)(-5.2)))
    assert event_of(Scene(right_hand=hand, objects={1: still(CUP), 2: laid})).held is None


def test_a_hold_is_told_by_a_reach_long_before_it() -> None:
    scene = Scene(
        right_hand=moving((-6.0, (0.0, 0.0, 0.2)), (-5.3, (0.0, 0.0, 0.54))),
        objects={1: still((0.0, 0.0, 0.7)), 2: still((-0.14, 0.0, 0.54))},
    )
    event = event_of(scene)
    assert event.object is not None and event.object.name == "cup"


def test_what_the_other_hand_laid_down_long_before_is_free_to_act_on() -> None:
    laid = moving((-6.0, (-0.3, 0.1, 0.4)), (-5.2, CUP))
    left = moving((-6.0, (-0.3, 0.18, 0.4)), (-5.2, (0.1, 0.08, 0.45)), (-4.5, REST_LEFT))
    right = moving((0.2, REST_RIGHT), (0.9, (0.1, 0.08, 0.4)))
    event = event_of(Scene(left_hand=left, right_hand=right, objects={1: laid}))
    assert (event.object and event.object.name, event.hand) == ("cup", "right")
