"""Postures that lack joints: each frame counts for what it shows, and none for more."""

import json
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fused
from actum.messages import Event, Objects, Posture
from actum.skeletons import INDEX, JOINTS
from scenes import HEAD, NAMES, Scene, acting_on, action, at, moving, still

CUP = (0.1, 0.0, 0.45)
TOUCH = acting_on(CUP, CUP, others={2: (-0.25, 0.0, 0.5)})
POSTURES, SIGHTINGS = TOUCH.postures(), TOUCH.sightings()
ARM = ("right_elbow", "right_hand")
FUSED = ("head", "right_shoulder", *ARM, "left_shoulder", "left_elbow", "left_hand")


def lacking(posture: Posture, *names: str) -> Posture:
    assert posture.joints_m is not None
    joints = [None if name in names else joint for name, joint in zip(JOINTS, posture.joints_m, strict=True)]
    return posture.model_copy(update={"joints_m": joints})


def event_of(
    postures: Sequence[Posture], sightings: Sequence[Objects], label: str, part: str | None = "right_arm"
) -> Event:
    """Feed fusion postures and objects, then the action; a null is no bad joint, and so counted as none."""
    return fused.event_of(*postures, *sightings, action(label, part=part))


@pytest.mark.parametrize("label", ["touch", "point"])
def test_joints_that_fusion_does_not_need_may_be_missing(label: str) -> None:
    others = [name for name in JOINTS if name not in FUSED]
    partial = [lacking(posture, *others) for posture in POSTURES]
    assert event_of(partial, SIGHTINGS, label) == event_of(POSTURES, SIGHTINGS, label)


@pytest.mark.parametrize("label", ["touch", "point"])
def test_without_a_posture_the_hand_is_not_known_whatever_is_in_sight(label: str) -> None:
    nothing = {"valid": False, "joints_m": None, "ego_from_camera": None}
    event = event_of([posture.model_copy(update=nothing) for posture in POSTURES], SIGHTINGS, label)
    assert (event.object, event.why, event.objects_present) == (None, "the hand is not known", [1, 2])


@given(st.integers(0, 10**6), st.floats(0.0, 1.0), st.sampled_from(["touch", "point"]))
@settings(max_examples=40)
def test_whatever_is_missing_when_the_event_is_one_of_finite_numbers(seed: int, share: float, label: str) -> None:
    rng = np.random.default_rng(seed)
    postures = [lacking(p, *[n for n in FUSED if rng.random() < share]) for p in POSTURES]
    event = event_of(postures, SIGHTINGS, label, part=None)
    json.dumps(event.model_dump(), allow_nan=False)
    assert event.objects_present == [1, 2]


@given(st.integers(0, 10**6), st.floats(0.0, 1.0))
@settings(max_examples=40)
def test_the_distance_is_the_smallest_of_the_frames_that_show_the_hand(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    postures = [lacking(p, "right_hand") if rng.random() < share else p for p in POSTURES]
    shown = [p for p in postures if p.joints_m and p.joints_m[INDEX["right_hand"]] and at(0) <= p.stamp_ns <= at(2)]
    hands = np.array([TOUCH.right_hand((p.stamp_ns - at(0)) / 1e9) for p in shown])
    event = event_of(postures, SIGHTINGS, "touch")
    if not shown:
        assert (event.object, event.distances_m) == (None, {})
    else:
        expected = np.linalg.norm(hands - np.array(CUP), axis=1).min()
        assert event.distances_m["1"] == pytest.approx(expected, abs=1e-6)


def pointing() -> Scene:
    """The stretched right arm points from the head through the fingertip at the box, then away from it at the cup.

    It does the second without a hand to be seen, in the tests below.
    """
    places = {1: (-0.6, 0.75, 2.0), 2: (0.6, 0.75, 2.0)}
    hands = {k: tuple(np.add(HEAD, 0.3 * np.subtract(place, HEAD)).tolist()) for k, place in places.items()}
    elbows = {k: tuple(np.add(HEAD, 0.1 * np.subtract(place, HEAD)).tolist()) for k, place in places.items()}
    return Scene(
        right_hand=moving((1.2, hands[2]), (1.3, hands[1])),
        right_elbow=moving((1.2, elbows[2]), (1.3, elbows[1])),
        objects={k: still(place) for k, place in places.items()},
    )


@pytest.mark.parametrize("name", ["head", *ARM])
def test_a_frame_without_the_whole_ray_tells_nothing_of_where_it_points(name: str) -> None:
    scene = pointing()
    partial = [lacking(p, name) if p.stamp_ns > at(1.2) else p for p in scene.postures()]
    for postures, expected in ((scene.postures(), 1), (partial, 2)):
        event = event_of(postures, scene.sightings(), "point")
        assert event.object is not None
        assert (event.object.id, event.object.name) == (expected, NAMES[expected])


@pytest.mark.parametrize("name", ["head", *ARM])
def test_a_ray_that_is_never_whole_points_at_nothing(name: str) -> None:
    scene = pointing()
    event = event_of([lacking(posture, name) for posture in scene.postures()], scene.sightings(), "point")
    assert event.object is None


def test_a_hand_and_an_elbow_known_in_turns_make_no_ray() -> None:
    scene = pointing()
    event = event_of([lacking(p, ARM[i % 2]) for i, p in enumerate(scene.postures())], scene.sightings(), "point")
    assert event.object is None
    assert event.distances_m


def test_of_two_hands_the_one_that_is_seen_acted() -> None:
    event = event_of([lacking(posture, "left_hand") for posture in POSTURES], SIGHTINGS, "touch", part=None)
    assert event.object is not None
    assert (event.object.id, event.hand) == (1, "right")
