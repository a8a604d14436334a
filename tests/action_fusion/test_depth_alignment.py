"""Objects are aligned in depth with a body whose distance is only guessed, as far as the guess may be off."""

from dataclasses import dataclass

import pytest

from actum import geometry
from actum.messages import Event, Posture
from fused import event_in
from scenes import REST_RIGHT, Place, Scene, acting_on, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)


@dataclass(frozen=True)
class Misplaced(Scene):
    """A scene whose actor seems to stand further away than they do, by a share of their distance."""

    share: float = 0.0
    depth_std_m: float | None = None

    def posture(self, seconds: float, seq: int | None = None, agent: int = 1, **fields: object) -> Posture:
        posture = super().posture(seconds, seq, agent, depth_std_m=self.depth_std_m, **fields)
        assert posture.joints_m is not None
        assert posture.ego_from_camera is not None
        camera_from_ego = geometry.invert(geometry.from_flat(posture.ego_from_camera))
        camera_from_ego[:3, 3] *= 1 + self.share
        joints = [None if joint is None else [c * (1 + self.share) for c in joint] for joint in posture.joints_m]
        ego_from_camera = geometry.flat(geometry.invert(camera_from_ego))
        return posture.model_copy(update={"joints_m": joints, "ego_from_camera": ego_from_camera})


def misplaced(scene: Scene, share: float, depth_std_m: float | None) -> Misplaced:
    return Misplaced(**vars(scene), share=share, depth_std_m=depth_std_m)


def name(event: Event) -> str | None:
    return event.object and event.object.name


def reach_for_the_cup() -> Scene:
    above = (CUP[0], CUP[1] + 0.08, CUP[2])
    return Scene(right_hand=moving((0.0, REST_RIGHT), (0.8, above)), objects={1: still(CUP)})


@pytest.mark.parametrize("share", [-0.18, 0.18])
def test_an_object_is_found_though_the_body_is_placed_too_near_or_too_far(share: float) -> None:
    assert name(event_in(misplaced(reach_for_the_cup(), share, None), action("act"))) is None
    told = event_in(misplaced(reach_for_the_cup(), share, depth_std_m=0.15), action("act"))
    assert name(told) == "cup"
    assert told.object is not None
    assert told.object.distance_m < 0.13


def test_what_is_beside_the_hand_in_the_image_stays_beside_it() -> None:
    scene = reach_for_the_cup()
    beside = Scene(right_hand=scene.right_hand, objects={1: still((CUP[0] + 0.35, CUP[1], CUP[2]))})
    assert name(event_in(misplaced(beside, 0.0, depth_std_m=0.15), action("act"))) is None


def test_an_object_further_behind_the_hand_than_the_depth_may_be_wrong_is_not_at_the_hand() -> None:
    scene = reach_for_the_cup()
    behind = Scene(right_hand=scene.right_hand, objects={1: still((CUP[0], CUP[1], CUP[2] - 0.7))})
    assert name(event_in(misplaced(behind, 0.0, depth_std_m=0.15), action("act"))) is None
    assert name(event_in(misplaced(behind, 0.0, depth_std_m=0.4), action("act"))) == "cup"


def test_the_displacement_is_as_it_was_seen() -> None:
    pushed = acting_on(CUP, (0.1, 0.0, 0.65))
    exact = event_in(pushed, action("push"))
    guessed = event_in(misplaced(pushed, 0.08, depth_std_m=0.15), action("push"))
    assert (name(exact), name(guessed)) == ("cup", "cup")
    assert exact.motion is not None
    assert guessed.motion is not None
    assert guessed.motion.displacement_m == pytest.approx(exact.motion.displacement_m, abs=0.01)


def test_a_measured_distance_needs_no_alignment() -> None:
    pushed = acting_on(CUP, (0.1, 0.0, 0.65), others={2: (0.3, 0.0, 0.5)})
    assert event_in(misplaced(pushed, 0.0, None), action("push")) == event_in(pushed, action("push"))
