"""A joint that is lost for a moment goes on with the body; for longer, nobody knows where it is."""

import numpy as np
import pytest
from numpy.typing import NDArray

from actum.messages import Posture
from actum.node import SECOND_NS
from actum.skeletons import INDEX, JOINTS
from people import FRAME_NS, STANDING, lacking, skeleton
from pose_preprocessor.bridging import BRIDGED_NS
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

Array = NDArray[np.float64]
WALKED_M = np.array([0.02, 0.0, -0.01])
HAND = INDEX["right_hand"]


def walking(frame: int) -> Array:
    return STANDING + frame * WALKED_M


def put(node: PosePreprocessor, stamp_ns: int, joints: Array) -> Posture:
    (posture,) = node.handle(skeleton(stamp_ns, joints))
    assert isinstance(posture, Posture)
    return posture


@pytest.fixture
def node() -> PosePreprocessor:
    """A preprocessor that has seen the walker once."""
    made = PosePreprocessor(PoseSettings.defaults())
    put(made, 0, walking(0))
    return made


@pytest.mark.parametrize("lost", [("right_hand",), ("torso",), ("neck", "left_hip", "right_shoulder"), JOINTS[1:]])
def test_a_walkers_lost_joints_walk_on(node: PosePreprocessor, lost: tuple[str, ...]) -> None:
    """However many: a single joint that is still there shows where the body went."""
    whole = PosePreprocessor(PoseSettings.defaults())
    put(whole, 0, walking(0))
    expected = put(whole, FRAME_NS, walking(1))
    found = put(node, FRAME_NS, lacking(walking(1), *lost))
    assert found.valid
    for field in ("joints", "upright"):
        np.testing.assert_allclose(getattr(found, field), getattr(expected, field), atol=1e-9)


def test_what_was_not_seen_is_not_told_as_measured_but_for_the_trunk(node: PosePreprocessor) -> None:
    found = put(node, FRAME_NS, lacking(walking(1), "right_hand", "torso", "neck"))
    assert found.joints_m is not None
    assert [JOINTS[index] for index, joint in enumerate(found.joints_m) if joint is None] == ["right_hand"]


@pytest.mark.parametrize(("gap_ns", "bridged"), [(BRIDGED_NS, True), (BRIDGED_NS + 1, False)])
def test_a_joint_is_bridged_no_longer_than_it_can_be_known(node: PosePreprocessor, gap_ns: int, bridged: bool) -> None:
    put(node, gap_ns // 2, lacking(walking(1), "right_hand"))
    found = put(node, gap_ns, lacking(walking(2), "right_hand"))
    assert found.upright is not None
    assert (found.upright[HAND] is not None) is bridged
    lost = put(node, 2 * SECOND_NS, lacking(walking(3), "torso"))
    assert (lost.valid, lost.reason) == (
        False,
        "missing_joint: the skeleton lacks the joints torso: let the camera see the person's trunk",
    )


def test_one_persons_joints_are_not_anothers(node: PosePreprocessor) -> None:
    other = skeleton(FRAME_NS, lacking(walking(1), "right_hand"))
    stranger = other.model_copy(update={"agents": [other.agents[0].model_copy(update={"agent": 2})]})
    (found,) = node.handle(stranger)
    assert isinstance(found, Posture) and found.upright is not None
    assert found.upright[HAND] is None


def test_an_absurd_frame_is_not_remembered(node: PosePreprocessor) -> None:
    absurd = walking(1)
    absurd[HAND] += 20.0
    assert not put(node, FRAME_NS, absurd).valid
    found = put(node, 2 * FRAME_NS, lacking(walking(2), "right_hand"))
    assert found.joints is not None
    whole = put(PosePreprocessor(PoseSettings.defaults()), 0, walking(2))
    np.testing.assert_allclose(found.joints[HAND], whole.joints[HAND], atol=1e-9)  # type: ignore[index]


def test_what_is_bridged_is_still_named_in_the_state(node: PosePreprocessor) -> None:
    put(node, FRAME_NS, lacking(walking(1), "right_hand"))
    assert node.counters.state == "running without right_hand"
