"""The compiled steps do what the NumPy code beside them does: installations with and without a compiler agree."""

import math
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
import pytest
from benchmarks.rig.numpy_alone import numpy_alone
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import Field, TypeAdapter, ValidationError

from action_fusion.choice.reaching import _closings
from action_fusion.intake.buffers import Hands
from action_fusion.tracks.comotion import Comotion, comotion
from action_fusion.tracks.hand_tracks import HandTrack, known_smoothed
from action_fusion.tracks.object_tracks import ObjectTrack
from action_fusion.tracks.track import bounds_m
from actum import core
from actum.arrays import Array, Mask, joints_to_array
from actum.core import steps
from actum.geometry import DegenerateError
from actum.messages import Joint, Posture
from actum.messages.base import Joints
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.som import Som
from people import FRAME_NS, STANDING, skeleton
from pose_preprocessor.body import body_of, known_body
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier import first_layer
from som_classifier.body_movement import movements
from som_classifier.convolutions import COORDINATES, FILTERS, INSTANTS, Convolutions, resampled
from som_classifier.first_layer import FirstMaps
from som_classifier.frames import Frame, frame_of
from som_classifier.handedness import left_arm_acts, limb_moments, mirrored
from som_classifier.kinematics import KinematicsFilter
from som_classifier.pyramid import PrefixSums, Pyramid, running_sums
from som_classifier.spotting.decoding import Decoder, Spans, decoded
from som_classifier.supervised import SupervisedLayer
from unmarked import spotting_model

pytestmark = pytest.mark.skipif(steps is None, reason="this installation found no C compiler")
R = TypeVar("R")
ROUNDING_M = 1e-14
"""By how much positions may differ: some units in the last place of joints that are metres from the camera."""


def of_joint(name: str) -> tuple[int, int]:
    """The first column of a joint's position in a row of inputs, and the first of the next joint's."""
    return 3 * INDEX[name], 3 * INDEX[name] + 3


def both(work: Callable[[], R]) -> tuple[R, R]:
    """What the work gives by compiled steps, and by NumPy alone."""
    compiled = work()
    with numpy_alone():
        return compiled, work()


def moving(seed: int, frames: int = 40, lacking: float = 0.0, up: list[float] | None = None) -> list[Posture]:
    """Postures of a person all of whose joints move smoothly, at uneven intervals, with pauses.

    Args:
        seed: of all that is random.
        frames: how many there are.
        lacking: the share of the frames that lack a hand.
        up: against gravity, in the camera frame.
    """
    rng, node = np.random.default_rng(seed), PosePreprocessor(PoseSettings.defaults())
    far_m, phases = rng.uniform(0.0, 0.1, (15, 3)), rng.uniform(0.0, 6.0, (15, 3))
    pauses = rng.random(frames) < 0.05
    stamps_ns = np.cumsum(rng.integers(FRAME_NS // 2, 2 * FRAME_NS, frames) + SECOND_NS * pauses)
    joints_m = [STANDING + far_m * np.sin(3e-9 * stamp_ns + phases) for stamp_ns in stamps_ns]
    for each in joints_m:
        each[INDEX["left_hand"]] = np.nan if rng.random() < lacking else each[INDEX["left_hand"]]
    skeletons = [
        skeleton(int(ns), each, seq=n).model_copy(update={"up_in_camera": up})
        for n, (ns, each) in enumerate(zip(stamps_ns, joints_m, strict=True))
    ]
    return [posture for each in skeletons for posture in node.handle(each) if isinstance(posture, Posture)]


def encoded(postures: list[Posture]) -> list[Frame]:
    filter_, encoder, frames = KinematicsFilter(), spotting_model().encoder(), []
    for posture in postures:
        frame = frame_of(posture, 0, filter_)
        frame.activity = encoder.encode(frame)
        frames.append(frame)
    return frames


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.3]), st.sampled_from([None, [0.1, -0.9, 0.25]]))
def test_postures_agree(seed: int, lacking: float, up: list[float] | None) -> None:
    for compiled, plain in zip(*both(lambda: moving(seed, lacking=lacking, up=up)), strict=True):
        assert compiled.valid and plain.valid
        for name in ("joints_m", "joints", "upright"):
            of_both = (joints_to_array(getattr(each, name)) for each in (compiled, plain))
            np.testing.assert_allclose(*of_both, rtol=0, atol=ROUNDING_M)
        for name in ("ego_from_camera", "motion"):
            np.testing.assert_allclose(getattr(compiled, name), getattr(plain, name), rtol=0, atol=ROUNDING_M)


NUMBERS = st.sampled_from([0.0, -0.5, 0.3, 1e-300, 99.0, 101.0, -1e300, math.inf, math.nan])


PLAIN = TypeAdapter(Annotated[list[Joint], Field(min_length=15, max_length=15)], config={"strict": True})
POINTS = st.none() | st.lists(NUMBERS | st.sampled_from([1, True, "0.5", None]), min_size=2, max_size=4)


def validated(adapter: TypeAdapter[list[Joint]], value: object) -> str | None:
    """What is valid, or None where nothing is; as text, in which NaN equals itself and 1.0 is not 1."""
    try:
        return repr(adapter.validate_python(value))
    except ValidationError:
        return None


PLAIN_POINTS = st.lists(st.none() | st.lists(NUMBERS, min_size=3, max_size=3), min_size=15, max_size=15)


@given(PLAIN_POINTS | st.lists(POINTS, min_size=14, max_size=16) | st.tuples(*[POINTS] * 15))
def test_the_same_joints_are_valid_and_of_the_same_value(joints: object) -> None:
    assert validated(TypeAdapter(Joints, config={"strict": True}), joints) == validated(PLAIN, joints)


@pytest.mark.filterwarnings("ignore:invalid value")
@given(
    st.lists(st.none() | st.lists(NUMBERS, min_size=3, max_size=3), min_size=15, max_size=15),
    st.none() | st.lists(st.none() | st.lists(st.just(0.1), min_size=3, max_size=3), min_size=15, max_size=15),
    st.sampled_from([0.01, 1e9]),
)
def test_the_same_postures_are_usable(joints: list[Joint], upright: list[Joint] | None, moved_m: float) -> None:
    posture = moving(0, 1)[0].model_copy(update={"joints": joints, "upright": upright, "motion": [moved_m] * 5})
    compiled, plain = both(lambda: frame_of(posture, 0, KinematicsFilter()))
    assert (compiled.valid, compiled.missing) == (plain.valid, plain.missing)
    if compiled.kinematics is not None and plain.kinematics is not None:
        np.testing.assert_array_equal(compiled.joints, plain.joints)
        np.testing.assert_array_equal(compiled.motion, plain.motion)
        np.testing.assert_array_equal(compiled.kinematics.posture, plain.kinematics.posture)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 50]))
def test_the_same_arm_acts(seed: int, frames: int) -> None:
    postures = np.random.default_rng(seed).normal(0, 0.1, (frames, 15, 3)) * np.linspace(0.1, 4.0, 15)[:, None]
    after = np.concatenate([[7, 7], limb_moments(postures).sum(axis=0).ravel()])
    for first in (after, np.concatenate([after[:2], after[2:].reshape(4, 8)[[1, 0, 3, 2]].ravel()])):
        compiled, plain = both(lambda now=first: left_arm_acts(np.zeros_like(now), now, 2))
        assert compiled == plain


@given(st.lists(st.floats(-2, 3, width=32), min_size=5, max_size=5))
def test_the_action_map_answers_alike(scores: list[float]) -> None:
    model = spotting_model()
    inputs = np.resize(np.array(scores, np.float32), len(model.labels))
    np.testing.assert_allclose(*both(lambda: model.action_map.activity(inputs)), rtol=1e-5, atol=1e-7)


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1))
def test_a_frame_adds_the_same_to_all_sums(seed: int) -> None:
    """But for steps of the quantisation where an activity lies between two."""
    postures = moving(seed)
    for compiled, plain in zip(*both(lambda: encoded(postures)), strict=True):
        assert compiled.kinematics is not None and plain.kinematics is not None
        of_both = [(each.kinematics.posture, each.kinematics.velocity) for each in (compiled, plain) if each.kinematics]
        np.testing.assert_allclose(*of_both, rtol=0, atol=ROUNDING_M)
        added = [frame.activity.after - frame.activity.before for frame in (compiled, plain)]
        assert np.abs(added[0].astype(np.int64) - added[1].astype(np.int64)).max() <= 1
        totals = [frame.activity.totals_after - frame.activity.totals_before for frame in (compiled, plain)]
        assert np.abs(totals[0] - totals[1]).max() <= 1
        assert compiled.activity.winners == plain.activity.winners


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 127, 300]), st.floats(0.01, 30.0))
def test_many_frames_add_to_all_sums_what_each_does_alone(seed: int, frames: int, far_m: float) -> None:
    """But for steps of the quantisation where an activity lies between two; also far from all units."""
    postures, velocities = np.random.default_rng(seed).normal(0, far_m, (2, frames, 15, 3))
    first = spotting_model().first
    alone = [first.frame_activities(*frame)[0] for frame in zip(postures, velocities, strict=True)]
    sums = first.running_sums(postures, velocities), running_sums(np.stack(alone))
    steps_of_each = [np.diff(each.astype(np.int64), axis=0) for each in sums]
    assert np.abs(steps_of_each[0] - steps_of_each[1]).max(initial=0) <= 1
    assert not sums[0][0].any()


def test_a_further_map_answers_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """A map is added by what it is shown, and by its channels."""
    knees = first_layer.Inputs(np.arange(*of_joint("right_knee")), np.arange(*of_joint("right_hip")), np.full(3, 2.0))
    monkeypatch.setattr(first_layer, "MAP_INPUTS", {"knees": knees, **first_layer.MAP_INPUTS})
    mirrored_too = first_layer.Channel("knees"), first_layer.Channel("knees", mirrored=True)
    monkeypatch.setattr(first_layer, "CHANNELS", (*first_layer.CHANNELS, *mirrored_too))
    before, rng = spotting_model().first, np.random.default_rng(0)
    units = before.postures.rows, before.postures.cols
    knee_map = Som(*units, rng.normal(0, 0.3, (units[0] * units[1], 3)).astype(np.float32))
    first = FirstMaps({**before.maps, "knees": knee_map}, {**before.contrasts, "knees": 0.1}, before.arm_shares)
    postures, velocities = rng.normal(0, 0.3, (2, 20, 15, 3))
    alone = [first.frame_activities(*frame) for frame in zip(postures, velocities, strict=True)]
    sums = first.running_sums(postures, velocities), running_sums(np.stack([as_seen for as_seen, _ in alone]))
    steps_of_each = [np.diff(each.astype(np.int64), axis=0) for each in sums]
    assert np.abs(steps_of_each[0] - steps_of_each[1]).max() <= 1
    one = first.unnormalised_activities(steps, postures[0], velocities[0]).reshape(2, len(first.shares), -1)
    one *= first.shares / one.sum(axis=2, keepdims=True)
    np.testing.assert_allclose(one.reshape(2, -1), alone[0], atol=1e-6)


def test_sums_of_frames_that_lack_a_joint_are_those_of_numpy() -> None:
    postures, velocities = np.random.default_rng(0).normal(0, 0.3, (2, 20, 15, 3))
    postures[3, 4] = velocities[3, 4] = np.nan
    np.testing.assert_array_equal(*both(lambda: spotting_model().first.running_sums(postures, velocities)))


@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_neurons_learn_the_same(seed: int, actions: int) -> None:
    rng = np.random.default_rng(seed)
    inputs, targets = rng.normal(size=(40, 21)), rng.integers(actions, size=40)
    untrained = SupervisedLayer.random(actions, 21, rng)
    trained = both(lambda: untrained.train(inputs, targets, 0.3, 3, np.random.default_rng(seed)).weights)
    np.testing.assert_allclose(*trained, rtol=0, atol=1e-12)


@given(st.integers(1, 80), st.booleans(), st.integers(0, 2**32 - 1), st.sampled_from([(1, 2, 4), (1,), (1, 2, 3, 5)]))
def test_pooled_vectors_are_the_same_to_the_bit(frames: int, still: bool, seed: int, levels: tuple[int, ...]) -> None:
    rng, pyramid = np.random.default_rng(seed), Pyramid(levels, 0.25)
    added = rng.integers(0, 2**15, (frames + 1, 37)).astype(np.uint32)
    sums = np.cumsum(added, axis=0, dtype=np.uint32) + np.uint32(rng.integers(2**32))
    moved_um = np.zeros(frames + 1, np.int64) if still else rng.integers(0, 50_000, frames + 1)
    segment = PrefixSums(list(sums), np.cumsum(moved_um))
    np.testing.assert_array_equal(*both(lambda: pyramid.vector(segment)))


def test_windows_are_read_by_the_same_arm() -> None:
    frames = encoded(moving(3))
    firsts = list(range(0, 30, 3))
    compiled, plain = both(lambda: spotting_model().pooled(frames, firsts))
    np.testing.assert_array_equal(compiled, plain)


@given(
    st.lists(st.tuples(st.integers(1, 40), st.integers(0, 3), st.integers(1, 30)), max_size=60),
    st.sets(st.integers(0, 59)),
    st.sampled_from([0.0, 0.15, 0.9]),
)
def test_the_same_candidates_are_decided_on(
    drawn: list[tuple[int, int, int]], restarts: set[int], overlap: float
) -> None:
    """Ends rise by 0 to 3, so that several end at once; equal gains leave the choice to the order."""
    lengths, steps_ns, gains = (np.array([each[n] for each in drawn], np.int64) for n in range(3))
    ends_ns = 100 + np.cumsum(steps_ns)
    spans = Spans(ends_ns - lengths, ends_ns, gains / 2)
    decisions_ns = np.union1d(ends_ns, 100 + np.arange(0, 200, 7))
    begins_anew = np.isin(np.arange(len(decisions_ns)), list(restarts))
    compiled, plain = both(lambda: decoded(Decoder(5, 60, overlap), spans, decisions_ns, begins_anew))
    assert compiled == plain


@given(st.integers(0, 2**32 - 1))
def test_features_of_convolutions_are_the_same_to_the_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    coordinates = (rng.random((FILTERS, COORDINATES)) < 0.1).astype(np.float32)
    convolutions = Convolutions(coordinates, rng.normal(0.0, 1.0, (FILTERS, 4)).astype(np.float32))
    series = rng.normal(0.0, 0.3, (COORDINATES, INSTANTS)).astype(np.float32)
    np.testing.assert_array_equal(*both(lambda: convolutions.features(series)))


@given(st.integers(1, 150), st.integers(1, 200), st.sampled_from([0.0, 0.01, 1.0]), st.integers(0, 2**32 - 1))
def test_what_complete_segments_are_judged_by_is_the_same_to_the_bit(
    frames: int, rate_hz: int, lacking: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    stamps_ns = rng.integers(0, 2**62) + np.cumsum(rng.integers(1, 2 * SECOND_NS // rate_hz, frames))
    postures = np.cumsum(rng.normal(0.0, 0.03, (frames, 15, 3)), axis=0)
    postures[rng.random((frames, 15)) < lacking] = np.nan
    mirror_image = mirrored(postures)
    np.testing.assert_array_equal(*both(lambda: resampled(stamps_ns, mirror_image)))
    (parts, moved_m), (parts_by_numpy, moved_by_numpy_m) = both(lambda: movements(stamps_ns, postures))
    np.testing.assert_array_equal(parts, parts_by_numpy)
    assert moved_m == moved_by_numpy_m


@given(st.integers(0, 30), st.integers(0, 2**32 - 1))
def test_running_sums_are_the_same_to_the_bit(frames: int, seed: int) -> None:
    activities = np.random.default_rng(seed).random((frames, 50)).astype(np.float32)
    np.testing.assert_array_equal(*both(lambda: running_sums(activities)))
    np.testing.assert_array_equal(*both(lambda: running_sums(activities.astype(np.float64))))


def wandering(rng: np.random.Generator, count: int) -> tuple[Array, Array]:
    """Stamps (n,) at uneven intervals, most of them before a segment's start, and positions (n, 3) that wander."""
    stamps_ns = np.cumsum(rng.integers(FRAME_NS // 2, 2 * FRAME_NS, count)) - 2.0 * SECOND_NS
    return stamps_ns, np.cumsum(rng.normal(0.0, 0.02, (count, 3)), axis=0)


@given(st.integers(1, 200), st.integers(1, 200), st.booleans(), st.sampled_from([0.03, 0.3]), st.integers(0, 2**32 - 1))
def test_a_hand_and_an_object_are_compared_alike(
    instants: int, sightings: int, in_hand: bool, moved_m: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    hand, seen = HandTrack("right", *wandering(rng, instants)), np.ones(sightings, np.bool_)
    stamps_ns, wandering_m = wandering(rng, sightings)
    track = ObjectTrack(1, "cup", stamps_ns, 0.2 * wandering_m + (hand.at(stamps_ns) if in_hand else 0.0), seen)
    compiled, plain = both(lambda: comotion(hand, track, 0.25, moved_m))
    for field in fields(Comotion):
        np.testing.assert_array_equal(getattr(compiled, field.name), getattr(plain, field.name))


@given(st.integers(1, 100), st.sampled_from([0.0, 0.3, 1.0]), st.integers(0, 2**32 - 1))
def test_hands_come_nearer_to_objects_by_the_same_share(instants: int, asked: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand = HandTrack("right", *wandering(rng, instants))
    objects = [ObjectTrack(n, "", *wandering(rng, 20), np.ones(20, dtype=bool)) for n in range(3)]
    pairs = [comotion(hand, each, reach_m=0.1, moved_m=0.03) for each in objects]
    at = rng.random(instants) < asked
    np.testing.assert_array_equal(*both(lambda: _closings(hand, pairs, at)))


@given(st.integers(1, 50), st.integers(0, 50), st.integers(0, 2**32 - 1))
def test_tracks_are_the_same_to_the_bit_at_stamps_in_any_order(known: int, asked: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    track = HandTrack("right", *wandering(rng, known))
    at_ns = rng.choice(np.concatenate([track.stamps_ns, rng.uniform(-3e9, 3e9, 50)]), asked)
    np.testing.assert_array_equal(*both(lambda: track.at(at_ns)))
    np.testing.assert_array_equal(*both(lambda: bounds_m(track.positions_m)))


@given(st.integers(0, 100), st.sampled_from([0.0, 0.3, 1.0]), st.integers(0, 1), st.integers(0, 2**32 - 1))
def test_hands_are_smoothed_alike_at_the_same_stamps(frames: int, lacking: float, number: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    (stamps_ns, right_m), (_, left_m) = wandering(rng, frames), wandering(rng, frames)
    hands_m = np.stack([right_m, left_m], axis=1)
    hands_m[rng.random((frames, 2)) < lacking] = np.nan
    for compiled, plain in zip(*both(lambda: known_smoothed(Hands(stamps_ns, hands_m), number)), strict=True):
        np.testing.assert_array_equal(compiled, plain)


@pytest.mark.parametrize("spoilt", ["hips", "bone", "far"])
def test_what_cannot_be_used_is_refused_alike(spoilt: str) -> None:
    joints = STANDING.copy()
    if spoilt == "hips":
        joints[9] = joints[12]
    joints[5] += {"hips": 0.0, "bone": 3.0, "far": 1e4}[spoilt]

    def refused() -> str | None:
        node = PosePreprocessor(PoseSettings.defaults())
        (posture,) = node.handle(skeleton(SECOND_NS, joints))
        assert not posture.valid
        return posture.reason

    compiled, plain = both(refused)
    assert compiled == plain is not None


def test_joints_that_coincide_are_refused_by_both() -> None:
    joints = STANDING.copy()
    joints[1] = joints[2]
    assert known_body(joints.tolist(), 10.0, 2.0) is None
    with pytest.raises(DegenerateError):
        body_of(joints)


def compare(hand_m: Array, object_m: Array, numbers: Array, marks: Mask) -> None:
    """Compare a hand of nine instants with an object of two sightings."""
    steps.comotion(np.zeros(9), hand_m, np.zeros(2), object_m, 1.0, 0.0, 0.8, 0.25, 0.03, 0.5, numbers, marks)


ZEROS = np.zeros(400)
POSE = [[float(n), 0.0, 2.0] for n in range(15)]


def pooled_by(spans: list[list[int]], frames: int = 2) -> None:
    """Pool spans of a run of frames as one cell of three units, into room for one vector."""
    sums, travelled_um = np.zeros((frames + 1, 3), np.uint32), np.zeros(frames + 1, np.int64)
    cells = np.array([0.0, 1.0]), np.array([0], np.int32), np.array([1], np.int32)
    steps.pooled(sums, travelled_um, np.array(spans), *cells, 1.0, np.empty(3, np.float32))


def pool_windows(rows: list[int], firsts: list[int]) -> None:
    """Pool windows of frames before which are these rows of a run of three, as one cell of three units."""
    run = np.zeros((3, 2, 3), np.uint32), np.zeros((3, 40), np.int64)
    cells = np.array([0.0, 1.0]), np.array([0], np.int32), np.array([1], np.int32)
    steps.pooled_windows([(run, row) for row in rows], firsts, True, 1.0, 1.0, *cells, 1.0, np.empty(3, np.float32))


def add_frame(row: int) -> None:
    """Add a frame to the sums in a row of a run of three."""
    activities, frame = np.zeros((2, 4), np.float32), (ZEROS, ZEROS, ZEROS, ZEROS, ZEROS, ZEROS)
    sums, totals = np.zeros((3, 2, 4), np.uint32), np.zeros((3, 40), np.int64)
    steps.added(activities, np.ones(4, np.float32), 1.0, *frame, 1e-9, sums, totals, row)


def add_frames(moving: int = 3, inputs: int = 1, sums: tuple[int, int] = (4, 4)) -> None:
    """Add three frames to sums of a layer of one unit, which has weights for one input."""
    layer = (*(ZEROS,) * 6, np.zeros(inputs, np.float32), np.zeros(32, np.float32), *(ZEROS,) * 5)
    steps.added_frames(np.zeros((3, 45)), np.zeros((moving, 45)), *layer, 1.0, np.zeros(sums, np.uint32))


@pytest.mark.parametrize(
    "call",
    [
        lambda: steps.body(POSE, ZEROS, ZEROS, ZEROS, ZEROS, 1.0, 1.0, 1.0, np.empty(2)),
        lambda: steps.smoothed(ZEROS, ZEROS, np.zeros(5), 0.03, 0.1, 1.0, 1.0, 1.0, 1.0, np.empty(180)),
        lambda: steps.usable(POSE, None, [0.0] * 5, 0, 10.0, np.empty(3)),
        lambda: steps.spreads(np.zeros(3, np.int64), np.zeros(3, np.int64)),
        lambda: steps.left_arm_acts(np.zeros(40, np.int64), np.zeros(40, np.int64), 20, 1.0, 1.0),
        lambda: steps.running_sums(np.zeros((3, 0), np.float32), 1.0, 0, np.zeros((4, 0), np.uint32)),
        lambda: steps.pooled(ZEROS, ZEROS, ZEROS, ZEROS, b"", b"", 1.0, np.empty(3, np.float32)),
        lambda: pooled_by(spans=[[0, 3]]),
        lambda: pooled_by(spans=[[-1, 1]]),
        lambda: pooled_by(spans=[[1, 1]]),
        lambda: pooled_by(spans=[[0, 2], [0, 1]]),
        lambda: pooled_by(spans=[[0, 2]], frames=1),
        lambda: add_frames(sums=(3, 4)),
        lambda: add_frames(sums=(4, 3)),
        lambda: add_frames(moving=2),
        lambda: add_frames(inputs=136),
        lambda: steps.adapted(np.ones((2, 3)), np.ones((4, 3)), np.zeros(4, np.int64), np.array([4]), 0.1),
        lambda: steps.adapted(np.ones((2, 3)), np.ones((4, 4)), np.zeros(4, np.int64), np.array([0]), 0.1),
        lambda: steps.bounds(np.empty((0, 3)), np.empty((2, 3))),
        lambda: steps.interpolated(np.zeros(9), np.zeros(2), np.zeros((2, 3)), np.empty((8, 3))),
        lambda: steps.interpolated(np.zeros(9), np.zeros(0), np.zeros((2, 3)), np.empty((9, 3))),
        lambda: steps.interpolated(np.zeros(9), np.zeros(3), np.zeros((2, 3)), np.empty((9, 3))),
        lambda: steps.smoothed_hand(np.zeros(9), np.zeros((8, 2, 3)), 0, 1.0, np.empty(9), np.empty((9, 3))),
        lambda: steps.smoothed_hand(np.zeros(9), np.zeros((9, 2, 3)), 0, 1.0, np.empty(9), np.empty((8, 3))),
        lambda: compare(np.zeros((8, 3)), np.zeros((2, 3)), np.empty(72), np.empty(27, np.bool_)),
        lambda: compare(np.zeros((9, 3)), np.zeros((1, 3)), np.empty(72), np.empty(27, np.bool_)),
        lambda: compare(np.zeros((9, 3)), np.zeros((2, 3)), np.empty(71), np.empty(27, np.bool_)),
        lambda: compare(np.zeros((9, 3)), np.zeros((2, 3)), np.empty(72), np.empty(26, np.bool_)),
        lambda: steps.resampled(np.zeros(0, np.int64), ZEROS[:45], b"", 32, np.empty((45, 32), np.float32)),
        lambda: steps.resampled(np.zeros(2, np.int64), ZEROS[:45], b"", 32, np.empty((45, 32), np.float32)),
        lambda: steps.resampled(np.zeros(1, np.int64), ZEROS[:45], bytes(8), 32, np.empty((48, 32), np.float32)),
        lambda: steps.movements(np.zeros(0, np.int64), ZEROS[:45], 1, bytes(4), bytes(4)),
        lambda: steps.movements(np.zeros(2, np.int64), ZEROS[:45], 1, bytes(4), bytes(4)),
        lambda: steps.closings(np.zeros(6), np.zeros(3, bool), 0.1, np.zeros(9), np.zeros(3), np.empty(3)),
        lambda: steps.closings(np.zeros(9), np.zeros(3, bool), 0.1, np.zeros(9), np.zeros(3), np.empty(2)),
        lambda: pool_windows([], [0]),
        lambda: pool_windows([0, 1], [2]),
        lambda: pool_windows([0, 1], [-1]),
        lambda: pool_windows([0, 2], [0]),
        lambda: pool_windows([-1], [0]),
        lambda: add_frame(row=2),
        lambda: add_frame(row=-1),
    ],
)
def test_arrays_that_are_too_short_are_refused_before_anything_is_read(call: Callable[[], object]) -> None:
    with pytest.raises(ValueError):
        call()


@pytest.mark.parametrize(
    "activity", [None, (), (None, 0), ((), 0), ((ZEROS,), 0), ((ZEROS, None), 0), ((ZEROS, ZEROS),)]
)
def test_a_frame_without_its_sums_is_refused_before_anything_is_read(activity: object) -> None:
    cells = np.array([0.0, 1.0]), np.array([0], np.int32), np.array([1], np.int32)
    with pytest.raises((TypeError, SystemError, IndexError)):
        steps.pooled_windows([activity], [0], True, 1.0, 1.0, *cells, 1.0, np.empty(3, np.float32))


def test_a_coordinate_that_is_no_plain_number_is_refused() -> None:
    class Odd:
        def __float__(self) -> float:
            return 1.0

    with pytest.raises(TypeError):
        steps.usable([[Odd(), 0.0, 0.0], *POSE[1:]], None, [0.0] * 5, 0, 10.0, np.empty(95))


def test_a_library_of_another_source_is_not_used(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    other = tmp_path / "_compiled.c"
    other.write_text("/* newer */")
    monkeypatch.setattr(core, "SOURCE", other)
    assert core._compiled() is None
    assert "make install" in caplog.text
    monkeypatch.setattr(core, "SOURCE", tmp_path / "none.c")
    assert core._compiled() is steps, "an installed package may have no source"


@given(st.integers(0, 2**32), st.booleans())
def test_kinematics_take_joints_however_they_lie_in_memory(seed: int, transposed: bool) -> None:
    plain, other = KinematicsFilter(), KinematicsFilter()
    joints = np.random.default_rng(seed).normal(size=(5, 15, 3))
    wide = np.pad(joints, ((0, 0), (0, 0), (0, 1)))
    for number, each in enumerate(joints):
        given_as = np.asfortranarray(each) if transposed else wide[number, :, :3]
        expected, got = plain.step(number * FRAME_NS, each), other.step(number * FRAME_NS, given_as)
        assert np.array_equal(expected.posture, got.posture) and np.array_equal(expected.velocity, got.velocity)
