"""People as NiTE 2 hands them over, in its bindings' own structures; NiTE itself was never at hand."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from actum.calibration import Calibration
from actum.messages import Image, Skeleton
from actum.node import Counters
from actum.skeletons import INDEX, JOINTS
from sensor_gateway.captured_picture import DepthPicture, Picture, UsersPicture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.nite import NiteCapture, Users, nite
from sensor_gateway.devices.openni2 import OpenNi2Capture
from sensor_gateway.lens import Lens
from sensor_gateway.optics import DepthOptics
from sensor_gateway.people.landmarks import Nobody
from sensor_gateway.perceiver import UsersPerceiver

try:
    from openni import _nite2, nite2
    from openni.utils import NiteError
except (ImportError, TypeError) as error:  # since Python 3.13 the bindings raise the second
    pytest.skip(f"the source openni2 needs OpenNI 2 (its bindings: {error})", allow_module_level=True)

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
    perceiver = UsersPerceiver(Nobody(), DepthOptics(), "kinect0", "test", Counters())

    sent = list(perceiver.messages(UsersPicture(image, 5, depth, lens, agents)))

    assert [type(message) for message in sent] == [Image, Skeleton]
    assert {message.stamp_ns for message in sent} == {5}
    assert sent[1].agents == list(agents)


def test_images_of_another_size_than_was_calibrated_show_nobody_and_that_is_said_and_counted() -> None:
    agents = tuple(Users(lambda _: None).agents([user(1)]))
    image, depth = np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.float32)
    calibration = Calibration(image_size=(640, 480), K=[500, 0, 320, 0, 500, 240, 0, 0, 1], distortion=[])
    counters = Counters()
    perceiver = UsersPerceiver(Nobody(), DepthOptics(calibration=calibration), "kinect0", "test", counters)

    [sent] = perceiver.messages(UsersPicture(image, 5, depth, Lens.of_field_of_view(64, 48, 58.0), agents))

    assert isinstance(sent, Skeleton)
    assert (sent.valid, sent.agents) == (False, [])
    assert sent.reason == "image_size_mismatch: 64x48, calibrated for 640x480"
    assert counters.rejects == {"image_size_mismatch": 1}


class Tracker:
    """A tracker that sees one person, all of whose calls succeed but those named."""

    def __init__(self, *failing: str) -> None:
        self.failing = failing
        self.frames_open = 0

    def __call__(self, device: object) -> "Tracker":
        return self

    def read_frame(self) -> AbstractContextManager[object]:
        self._call("read_frame")
        return self._frame()

    def start_skeleton_tracking(self, number: int) -> None:
        self._call("start_skeleton_tracking")

    def close(self) -> None:
        self._call("close")

    def _call(self, name: str) -> None:
        if name in self.failing:
            raise NiteError(_nite2.NiteStatus.NITE_STATUS_ERROR)

    @contextmanager
    def _frame(self) -> Iterator[object]:
        self.frames_open += 1
        try:
            yield SimpleNamespace(users=[user(1)])
        finally:
            self.frames_open -= 1


@pytest.fixture
def capture_with(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[Tracker], NiteCapture]:
    """Give a camera that always has a picture, with a tracker."""
    picture = DepthPicture(
        np.zeros((48, 64, 3), np.uint8), 5, np.zeros((48, 64), np.float32), Lens.of_field_of_view(64, 48, 58.0)
    )

    def has_a_picture(capture: NiteCapture, patience_s: float) -> Picture:
        capture._opened()
        return picture

    monkeypatch.setattr("sensor_gateway.devices.openni2.library", lambda: None)
    monkeypatch.setattr(OpenNi2Capture, "_opened", lambda _: SimpleNamespace(device=None, close=lambda: None))
    monkeypatch.setattr(OpenNi2Capture, "next", has_a_picture)
    return lambda tracker: NiteCapture(SimpleNamespace(loaded_dll_directory=tmp_path, UserTracker=tracker))


def test_a_camera_gives_its_picture_with_the_people_in_it(capture_with: Callable[[Tracker], NiteCapture]) -> None:
    tracker = Tracker()
    seen = capture_with(tracker).next(0.1)
    assert isinstance(seen, UsersPicture)
    assert [agent.agent for agent in seen.agents] == [1]
    assert tracker.frames_open == 0


@pytest.mark.parametrize("failing", ["read_frame", "start_skeleton_tracking"])
def test_where_nite_fails_the_camera_is_lost_and_can_be_let_go_of(
    capture_with: Callable[[Tracker], NiteCapture], failing: str
) -> None:
    tracker = Tracker(failing, "close")
    capture = capture_with(tracker)
    with pytest.raises(CameraLostError, match=r"NiTE says: .*NITE_STATUS_ERROR"):
        capture.next(0.1)
    capture.close()
    assert tracker.frames_open == 0


def test_where_no_installer_has_named_its_folder_there_is_no_nite(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NITE2_REDIST", raising=False)
    monkeypatch.delenv("NITE2_REDIST64", raising=False)

    assert nite() is None


def test_a_folder_without_its_library_is_no_nite(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("openni")
    monkeypatch.setattr("sensor_gateway.devices.nite.library", lambda: None)
    monkeypatch.setattr("openni.openni2.is_initialized", lambda: True)
    monkeypatch.setenv("NITE2_REDIST64", str(tmp_path))

    assert nite() is None
