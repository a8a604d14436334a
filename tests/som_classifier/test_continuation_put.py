"""With each posture of a person who moves, the classifier puts where the joints are expected, if somebody listens."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from actum.arrays import joints_to_array
from actum.messages import Continuation, Message, Posture, Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.standard_body import bones_of
from continued import KINDS, at_this_speed, continued
from people import FRAME_NS, STANDING, lacking, reaches, reaching, skeleton, turned
from performers import mark
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings
from recognisers import tiny_model
from som_classifier.frames import frame_of
from som_classifier.kinematics import KinematicsFilter
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.placed_continuation import in_camera, joints_in_camera
from som_classifier.regressed_continuation import ANSWERS
from wire import Wire, without_seq

Joints = NDArray[np.float64]
HAND, ELBOW = INDEX["right_hand"], INDEX["right_elbow"]
FRAMES = 40


def postures_of(skeletons: Sequence[Skeleton]) -> list[Posture]:
    node = PosePreprocessor(Settings.defaults())
    return [output for each in skeletons for output in node.handle(each) if isinstance(output, Posture)]


def put(messages: Sequence[Message], model: Model | None = None) -> list[Continuation]:
    outputs = Wire(SomClassifier(model or at_this_speed())).send(*messages)
    return [output for output in outputs if isinstance(output, Continuation)]


def turning_forearm(at_rad: float) -> Joints:
    """The right hand on its way round the elbow, before the body."""
    joints, elbow = STANDING.copy(), STANDING[ELBOW]
    length_m = np.linalg.norm(STANDING[HAND] - elbow)
    joints[HAND] = elbow + length_m * np.array([np.sin(at_rad), np.cos(at_rad), 0.0])
    return joints


def in_place(joints: Joints, up_in_camera: Sequence[float] | None = None) -> Joints:
    """Where a posture that stays as it is is expected."""
    seen = skeleton(0, joints).model_copy(update={"up_in_camera": up_in_camera})
    [posture] = postures_of([seen])
    frame = frame_of(posture, 0, KinematicsFilter())
    now_m = joints_in_camera(posture)
    assert frame.upright is not None and now_m is not None
    return in_camera(frame.upright[None], frame, now_m)[0]


def test_joints_are_expected_where_they_get_at_their_speed() -> None:
    """The hand turns by 1 rad/s; it is expected to go on along the tangent."""
    turned_rad = [i * FRAME_NS / SECOND_NS for i in range(FRAMES)]
    frames = [skeleton(i * FRAME_NS, turning_forearm(at_rad)) for i, at_rad in enumerate(turned_rad)]
    newest = put(postures_of(frames))[-1]
    now, before = turning_forearm(turned_rad[-1])[HAND], turning_forearm(turned_rad[-1] - 0.01)[HAND]
    assert newest.stamp_ns == frames[-1].stamp_ns
    assert [each.ahead_s for each in newest.ahead] == [0.25, 0.5, 1.0]
    for each in newest.ahead[:2]:
        expected = now + each.ahead_s * (now - before) / 0.01
        assert joints_to_array(each.joints_m)[HAND] == pytest.approx(expected, abs=0.04)


def test_no_bone_is_expected_to_be_longer_than_the_persons_own() -> None:
    """A model that was taught by people who stand may expect anything of one who sits."""
    model = at_this_speed()
    assert model.continuation is not None
    far_m = np.linspace(-3.0, 3.0, ANSWERS, dtype=np.float32)
    frames = reaches(FRAMES)
    newest = put(postures_of(frames), replace(model, continuation=replace(model.continuation, offsets=far_m)))[-1]
    own_m2 = bones_of(joints_to_array(frames[-1].agents[0].joints))[1]
    for each in newest.ahead:
        assert (bones_of(joints_to_array(each.joints_m))[1] <= own_m2 * (1 + 1e-6)).all()


@pytest.mark.parametrize(
    "joints",
    [STANDING, 1.2 * STANDING, reaching(0.7, 0.6), turned(STANDING, 0.8), lacking(STANDING, "left_foot")],
    ids=["standing", "tall", "small and reaching", "turned", "without a foot"],
)
@pytest.mark.parametrize("up_in_camera", [None, [0.1, -1.0, -0.4]], ids=["level", "tilted"])
def test_a_posture_that_stays_is_expected_where_it_is(joints: Joints, up_in_camera: list[float] | None) -> None:
    assert in_place(joints, up_in_camera) == pytest.approx(joints, abs=1e-9, nan_ok=True)


def test_a_joint_beyond_a_missing_one_is_not_expected_anywhere() -> None:
    expected = in_place(lacking(STANDING, "right_elbow"))
    assert np.flatnonzero(np.isnan(expected[:, 0])).tolist() == [ELBOW, HAND]


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_put_of_who_stands(kind: str) -> None:
    rng = np.random.default_rng(0)
    still = [skeleton(i * FRAME_NS, STANDING + rng.normal(0, 0.005, (15, 3))) for i in range(3 * FRAMES)]
    assert put(postures_of(still), continued(kind)) == []


def test_who_has_stopped_is_continued_for_half_a_second() -> None:
    """The hand turns by 2 rad/s for 0.8 s; it is seen to have stopped a little later."""
    rng, stamps_ns = np.random.default_rng(0), range(0, 90 * FRAME_NS, FRAME_NS)
    turned = [turning_forearm(2 * min(stamp_ns / SECOND_NS, 0.8)) for stamp_ns in stamps_ns]
    noisy = [joints + rng.normal(0, 0.001, (15, 3)) for joints in turned]
    frames = [skeleton(stamp_ns, joints) for stamp_ns, joints in zip(stamps_ns, noisy, strict=True)]
    assert 1.3 <= put(postures_of(frames))[-1].stamp_ns / SECOND_NS < 1.8


@pytest.mark.parametrize("kind", KINDS)
def test_each_has_the_stamp_and_the_origin_of_its_posture(kind: str) -> None:
    postures = postures_of(reaches(FRAMES))
    continuations = put(postures, continued(kind))
    assert len(continuations) > FRAMES // 2
    assert {each.stamp_ns for each in continuations} <= {each.stamp_ns for each in postures}
    assert {(each.sensor, each.agent, each.session_id) for each in continuations} == {("kinect0", 1, "test")}


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=5)
@given(cut=st.integers(1, FRAMES))
def test_no_later_posture_changes_what_was_put(kind: str, cut: int) -> None:
    postures = postures_of(reaches(FRAMES))
    whole, until = put(postures, continued(kind)), put(postures[:cut], continued(kind))
    stamps = {each.stamp_ns for each in postures[:cut]}
    assert until == [each for each in whole if each.stamp_ns in stamps]


def test_marks_change_nothing() -> None:
    postures = postures_of(reaches(FRAMES))
    marks = mark("start", 5 * FRAME_NS, "one"), mark("end", 30 * FRAME_NS, "one")
    assert put([marks[0], *postures[:20], marks[1], *postures[20:]]) == put(postures) != []


def test_nothing_is_put_while_nobody_listens_and_all_else_is_put_as_before() -> None:
    postures = [mark("start", 0, "one"), *postures_of(reaches(FRAMES)), mark("end", 30 * FRAME_NS, "one")]
    node = SomClassifier(at_this_speed())
    node.is_demanded = False
    quiet, demanded = Wire(node).send(*postures), Wire(SomClassifier(at_this_speed())).send(*postures)
    others = [each for each in demanded if not isinstance(each, Continuation)]
    assert without_seq(quiet) == without_seq(others) != []
    assert len(others) < len(demanded)


def test_a_model_that_was_not_trained_for_it_puts_none() -> None:
    assert put(postures_of(reaches(FRAMES)), tiny_model()) == []


@pytest.mark.parametrize("fields", [{"agent": 0}, {"valid": False, "reason": "lost", "joints_m": None}])
def test_nobody_known_and_no_valid_posture_give_none(fields: dict[str, object]) -> None:
    assert put([each.model_copy(update=fields) for each in postures_of(reaches(FRAMES))]) == []


@pytest.mark.parametrize(
    "fields",
    [
        {"joints_m": None},
        {"joints_m": [[np.inf, 0.0, 0.0]] * 15},
        {"ego_from_camera": None},
        {"ego_from_camera": [1e308] * 16},
        {"ego_from_camera": [0.0] * 16},
    ],
    ids=["no joints_m", "infinite joints", "no frame", "a huge frame", "a frame of zeros"],
)
def test_a_person_whose_place_is_unusable_is_counted_and_not_continued(fields: dict[str, object]) -> None:
    wire = Wire(SomClassifier(at_this_speed()))
    sent = [each.model_copy(update=fields) for each in postures_of(reaches(FRAMES))]
    assert not any(isinstance(output, Continuation) for output in wire.send(*sent))
    assert wire.rejects > FRAMES // 2
    assert "no usable place" in (wire.node.counters.last_error or "")


def test_an_absurd_joint_is_left_out_alone() -> None:
    absurd = []
    for posture in postures_of(reaches(FRAMES)):
        joints = [*(posture.joints_m or [])]
        joints[HAND] = [1e9, 0.0, 0.0]
        absurd.append(posture.model_copy(update={"joints_m": joints}))
    last = put(absurd)[-1].ahead[-1].joints_m
    assert [number for number, joint in enumerate(last) if joint is None] == [HAND]
