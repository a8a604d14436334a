"""People as NiTE 2 hands them over, in its bindings' own structures; NiTE itself was never at hand."""

from pathlib import Path

import numpy as np
import pytest

from actum.messages import Image, Skeleton
from actum.node import Tally
from actum.skeletons import INDEX, JOINTS
from sensor_gateway.camera.lens import Lens
from sensor_gateway.depth.nite import Nobody, Users, UsersPerceiver, UsersPicture, nite
from sensor_gateway.depth.picture import DepthOptics

openni = pytest.importorskip("openni", reason="the source openni2 needs OpenNI 2 (its bindings)")
from openni import _nite2, nite2  # noqa: E402 - only where they are installed

VISIBLE, NEW, LOST = 1, 3, 4
TRACKED = 2
JOINT_TYPES = {name: getattr(_nite2.NiteJointType, f"NITE_JOINT_{name.upper()}").value for name in JOINTS}


def user(number: int, state: int = VISIBLE, tracked: bool = True, mirrored: bool = False, x_mm: float = 100.0):
    """Somebody 2 m away who faces the camera; each joint's confidence tells its number."""
    data = _nite2.NiteUserData()
    data.id, data.state = number, state
    data.skeleton.state = TRACKED if tracked else 0
    for name, kind in JOINT_TYPES.items():
        joint = data.skeleton.joints[kind]
        side = {"left": 150.0, "right": -150.0}.get(name.partition("_")[0], 0.0)
        joint.position.x = x_mm + (-side if mirrored else side)
        joint.position.y, joint.position.z = 500.0 - 50 * INDEX[name], 2000.0
        joint.positionConfidence = 0.2 + INDEX[name] / 20
    return nite2.UserData(data)


def test_every_joint_comes_under_its_own_name_in_metres_with_y_down() -> None:
    [agent] = Users(lambda _: None).agents([user(1)])

    for name, i in INDEX.items():
        side = {"left": 0.15, "right": -0.15}.get(name.partition("_")[0], 0.0)
        assert agent.joints[i] == pytest.approx([0.1 + side, -0.5 + 0.05 * i, 2.0])
        assert agent.confidence[i] == pytest.approx(0.2 + i / 20)


def test_left_is_the_actors_left_even_where_nite_looked_at_a_mirror_image() -> None:
    users = Users(lambda _: None)
    [agent] = users.agents([user(1, mirrored=True)])
    assert agent.joints[INDEX["left_hand"]][0] > agent.joints[INDEX["right_hand"]][0]

    [turned] = users.agents([user(1, mirrored=False)])
    assert turned.joints[INDEX["left_hand"]][0] < turned.joints[INDEX["right_hand"]][0], "decided once for each person"


def test_somebody_new_has_their_skeleton_tracked_and_is_an_agent_once_it_is() -> None:
    followed: list[int] = []
    users = Users(followed.append)

    assert users.agents([user(7, NEW, tracked=False)]) == []
    assert users.agents([user(7, tracked=False)]) == []
    assert [agent.agent for agent in users.agents([user(7)])] == [1]
    assert followed == [7]


def test_a_number_that_nite_gives_to_somebody_else_is_another_agent() -> None:
    followed: list[int] = []
    users = Users(followed.append)

    assert [agent.agent for agent in users.agents([user(1), user(2)])] == [1, 2]
    assert [agent.agent for agent in users.agents([user(1, LOST), user(2)])] == [2]
    assert [agent.agent for agent in users.agents([user(1), user(2)])] == [3, 2]
    assert followed == [1, 2, 1]


def test_a_joint_that_nite_is_not_sure_of_is_missing_but_not_the_trunk() -> None:
    unsure = user(1)
    for name in ("left_foot", "torso"):
        unsure.skeleton.joints[JOINT_TYPES[name]].positionConfidence = 0.0

    [agent] = Users(lambda _: None).agents([unsure])

    assert [name for name, i in INDEX.items() if agent.joints[i] is None] == ["left_foot"]


def test_its_people_are_put_with_the_image_they_came_with() -> None:
    agents = tuple(Users(lambda _: None).agents([user(1)]))
    lens = Lens.of_field_of_view(64, 48, 58.0)
    image, depth = np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.float32)
    perceiver = UsersPerceiver(Nobody(), DepthOptics(), "kinect0", "test", Tally())

    sent = list(perceiver.messages(UsersPicture(image, 5, depth, lens, agents)))

    assert [type(message) for message in sent] == [Image, Skeleton]
    assert {message.stamp_ns for message in sent} == {5}
    assert sent[1].agents == list(agents)


def test_where_no_installer_has_named_its_folder_there_is_no_nite(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NITE2_REDIST", raising=False)
    monkeypatch.delenv("NITE2_REDIST64", raising=False)

    assert nite() is None


def test_a_folder_without_its_library_is_no_nite(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("openni")
    monkeypatch.setattr("sensor_gateway.depth.nite.library", lambda: None)
    monkeypatch.setattr("openni.openni2.is_initialized", lambda: True)
    monkeypatch.setenv("NITE2_REDIST64", str(tmp_path))

    assert nite() is None
