"""An occluded object is where it is tracked in the image, if a hand that grasped it and still has it explains that."""

from dataclasses import replace

import numpy as np
import pytest

from actum.messages import Event
from fused import event_in, event_of
from scenes import Place, Scene, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
UP: Place = (0.1, 0.2, 0.45)
IN_HAND: Place = (0.1, 0.06, 0.45)
LIFTED = moving((0.8, CUP), (1.5, UP))


def lifting(hand_end: Place = (0.13, 0.31, 0.42), hidden_until_s: float = 9.0) -> Scene:
    """A lift whose hand is seen 5 cm too high at its end; the cup is occluded from the grasp on, and image-tracked."""
    return Scene(
        right_hand=moving((0.3, (0.2, 0.1, 0.2)), (0.7, IN_HAND), (0.8, IN_HAND), (1.5, hand_end)),
        objects={1: LIFTED},
        hidden=lambda _, t: 0.7 < t < hidden_until_s,
        followed={1: LIFTED},
    )


def event_lifting(scene: Scene, label: str = "lift", **chosen: object) -> Event:
    return event_in(scene, action(label), **chosen)


def displacement_m(event: Event) -> np.ndarray:
    assert event.motion is not None
    return np.array(event.motion.displacement_m)


def test_it_goes_where_it_is_tracked_in_the_image_and_not_where_the_joint_strays() -> None:
    event = event_lifting(lifting())
    assert event.object is not None
    assert (event.object.carried, event.outcome) == (True, "lifted")
    assert np.allclose(displacement_m(event), (0.0, 0.2, 0.0), atol=0.005)


def test_where_image_tracking_ends_it_goes_on_with_the_hand() -> None:
    half = lifting(hand_end=(0.1, 0.26, 0.45))
    lost = replace(half, followed={})
    sightings = [(half if t < 1.15 else lost).objects_seen(t) for t in np.arange(-1.0, 3.5, 1 / 30).tolist()]
    event = event_of(*half.postures(), *sightings, action("lift"))
    assert np.allclose(displacement_m(event), (0.0, 0.2, 0.0), atol=0.02)


def test_seen_again_elsewhere_it_is_there() -> None:
    scene = replace(lifting(hidden_until_s=1.7), followed={1: still(CUP)})
    assert np.allclose(displacement_m(event_lifting(scene)), (0.0, 0.2, 0.0), atol=0.005)


def test_what_no_hand_came_near_has_not_moved() -> None:
    scene = replace(lifting(), right_hand=moving((0.5, (0.6, 0.1, 0.3)), (1.5, (0.6, 0.4, 0.3))))
    event = event_lifting(scene, "wave")
    assert event.object is None


@pytest.mark.parametrize("up_m", [0.15, 0.45])
def test_an_image_tracked_position_that_the_hand_does_not_explain_is_dropped(up_m) -> None:
    hand = moving((0.3, (0.2, 0.1, 0.2)), (0.7, IN_HAND), (0.8, IN_HAND), (1.5, (0.1, 0.06 + up_m, 0.45)))
    true = moving((0.8, CUP), (1.5, (0.1, up_m, 0.45)))
    scene = replace(lifting(), right_hand=hand, objects={1: true}, followed={1: still(CUP)})
    assert np.allclose(displacement_m(event_lifting(scene)), (0.0, up_m, 0.0), atol=0.02)


def test_what_was_occluded_before_the_action_began_can_be_acted_on() -> None:
    hand = moving((0.8, IN_HAND), (1.5, (0.1, 0.26, 0.45)))
    event = event_lifting(replace(lifting(), right_hand=hand, hidden=lambda _, t: t > -9))
    assert event.object is not None
    assert (event.object.id, event.outcome) == (1, "lifted")


def test_the_plain_measure_takes_sightings_alone() -> None:
    event = event_lifting(lifting(), measure="proximity")
    assert event.object is not None
    assert (event.object.carried, event.outcome) == (False, "unmoved")
