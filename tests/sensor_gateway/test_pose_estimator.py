"""The pose model itself, on real people."""

import zipfile
from collections import Counter
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import cv2
import numpy as np
import pytest

from actum.messages import Joint, Skeleton
from actum.node import SECOND_NS, Counters
from actum.skeletons import INDEX
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.video import pictures_of
from sensor_gateway.lens import Lens
from sensor_gateway.optics import Optics
from sensor_gateway.people.pose_estimator import BLANK, PoseEstimator, PoseModelError
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings
from sensor_gateway.sources import source_of

RAISED_HAND = "florence3d_rgb/GestureRecording_Id1actor1idAction1category1.mp4"
"""Somebody raises a hand. The clip is a mirror image: only turned back can the writing on their chest be read."""


def seen(path: Path, model: Path, optics: Optics, people: int = 1, doubled: bool = False) -> list[Skeleton]:
    with PoseEstimator(model, people) as estimator:
        perceiver = Perceiver(estimator, optics, "kinect0", "test", Counters())
        return [perceiver.skeleton(twice(picture) if doubled else picture) for picture in pictures_of(path)]


def twice(picture: Picture) -> Picture:
    """Put the middle of a picture beside itself, as if there were two."""
    middle = picture.image_bgr[:, 160:480]
    return Picture(np.ascontiguousarray(np.hstack([middle, middle])), picture.stamp_ns)


def joint(skeleton: Skeleton, name: str) -> list[float]:
    [agent] = skeleton.agents
    place: Joint = agent.joints[INDEX[name]]
    assert place is not None
    return place


def test_a_missing_model_is_told_with_the_command_that_gets_it(tmp_path: Path) -> None:
    with pytest.raises(PoseModelError, match="'actum models fetch'"):
        PoseEstimator(tmp_path / "pose.task")
    with pytest.raises(PoseModelError, match="'actum models fetch'"):
        source_of(Settings(source="camera", pose_model=tmp_path / "pose.task"), 0)


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (PermissionError("Unable to open file at pose.task"), "cannot be read by the current user"),
        (FileNotFoundError("No file with name: pose_detector.tflite"), "is not a pose model .*'actum models fetch'"),
        (OSError("libGLESv2.so.2: cannot open shared object file"), "apt install libegl1 libgles2"),
    ],
)
def test_why_the_model_cannot_be_opened_is_told(
    error: OSError, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_options: object) -> None:
        raise error

    landmarker = SimpleNamespace(create_from_options=refuse)
    vision = SimpleNamespace(
        PoseLandmarker=landmarker, PoseLandmarkerOptions=dict, RunningMode=SimpleNamespace(VIDEO=None)
    )
    mediapipe = SimpleNamespace(tasks=SimpleNamespace(vision=vision, BaseOptions=dict))
    monkeypatch.setattr("sensor_gateway.people.pose_estimator._mediapipe", lambda: mediapipe)
    (tmp_path / "pose.task").touch()
    with pytest.raises(PoseModelError, match=told):
        PoseEstimator(tmp_path / "pose.task")


class Counted:
    """Stands in for MediaPipe: finds as many as there are, and counts how often it looks, by how many it looks for."""

    there = 1
    looks: ClassVar[Counter[int]] = Counter()

    def __init__(self, _model: Path, people: int) -> None:
        self.people_at_most = people

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[str]:
        Counted.looks[self.people_at_most] += 1
        return ["somebody"] * min(Counted.there, self.people_at_most)


def looks_while(estimator: PoseEstimator, there: int, seconds: range) -> tuple[Counter[int], int]:
    """Look ten times a second; return who looked how often, and how many were found last."""
    Counted.there, Counted.looks = there, Counter()
    found = [estimator.people(BLANK, (10 * s + i) * SECOND_NS // 10) for s in seconds for i in range(10)]
    return Counted.looks, len(found[-1])


def test_others_are_looked_for_once_a_second_until_there_is_somebody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sensor_gateway.people.pose_estimator.Landmarker", Counted)
    (tmp_path / "pose.task").touch()
    estimator = PoseEstimator(tmp_path / "pose.task", people=3)
    assert looks_while(estimator, 1, range(4)) == ({1: 40, 3: 4}, 1)
    assert looks_while(estimator, 2, range(4, 8)) == ({3: 40}, 2)
    assert looks_while(estimator, 1, range(8, 12)) == ({3: 19 + 2, 1: 21}, 1)
    assert looks_while(PoseEstimator(tmp_path / "pose.task", people=1), 2, range(4)) == ({1: 40}, 1)


def bundle_of_another_kind() -> bytes:
    with zipfile.ZipFile(file := BytesIO(), "w") as bundle:
        bundle.writestr("hand_detector.tflite", b"")
    return file.getvalue()


@pytest.mark.pose_model
@pytest.mark.parametrize("content", [b"no model" * 1000, bundle_of_another_kind()], ids=["no model", "a hand's"])
def test_what_is_no_pose_model_is_told_likewise(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "pose.task").write_bytes(content)
    with pytest.raises(PoseModelError, match=r"pose\.task is not a pose model .*'actum models fetch'"):
        PoseEstimator(tmp_path / "pose.task")


@pytest.mark.data
@pytest.mark.pose_model
@pytest.mark.parametrize(("mirrored", "raised", "other"), [(True, "right", "left"), (False, "left", "right")])
def test_left_is_the_actors_own_left(data: Path, pose_model: Path, mirrored: bool, raised: str, other: str) -> None:
    last = seen(data / RAISED_HAND, pose_model, Optics(mirrored=mirrored))[-1]
    assert joint(last, f"{raised}_hand")[1] < joint(last, "head")[1] - 0.2, "the raised hand is above the head"
    assert joint(last, f"{other}_hand")[1] > joint(last, "torso")[1], "the other one hangs"
    assert joint(last, "left_shoulder")[0] > joint(last, "right_shoulder")[0], "they face the camera"
    assert joint(last, "left_foot")[0] > joint(last, "right_foot")[0]


@pytest.mark.data
@pytest.mark.pose_model
def test_a_person_is_found_in_nearly_every_frame_stands_upright_and_stays_one_agent(
    data: Path, pose_model: Path
) -> None:
    skeletons = seen(data / RAISED_HAND, pose_model, Optics())
    assert [len(skeleton.agents) for skeleton in skeletons].count(1) >= 26
    assert {agent.agent for skeleton in skeletons for agent in skeleton.agents} == {1}
    first = skeletons[0]
    stature_m = joint(first, "left_foot")[1] - joint(first, "head")[1]
    assert 1.3 < stature_m < 1.7
    assert 2.0 < joint(first, "torso")[2] < 3.5


@pytest.mark.data
@pytest.mark.pose_model
def test_two_people_are_two_agents(data: Path, pose_model: Path) -> None:
    skeletons = seen(data / RAISED_HAND, pose_model, Optics(), people=2, doubled=True)
    agents = [[agent.agent for agent in skeleton.agents] for skeleton in skeletons]
    assert {frozenset(found) for found in agents[3:]} == {frozenset({1, 2})}
    torsos = [{a.agent: a.joints[INDEX["torso"]] for a in skeleton.agents} for skeleton in skeletons[3:]]
    assert len({found[1][0] < found[2][0] for found in torsos if found[1] and found[2]}) == 1


@pytest.mark.data
@pytest.mark.pose_model
def test_the_joints_lie_where_the_person_is_in_the_picture(data: Path, pose_model: Path) -> None:
    skeleton = seen(data / RAISED_HAND, pose_model, Optics())[0]
    lens = Lens.of_field_of_view(640, 480, 60.0)
    joints = np.array([place for place in skeleton.agents[0].joints if place is not None])
    pixels = cv2.projectPoints(joints, np.zeros(3), np.zeros(3), lens.matrix, lens.distortion)[0].reshape(-1, 2)
    assert pixels.min(axis=0) == pytest.approx([195, 125], abs=25)
    assert pixels.max(axis=0) == pytest.approx([355, 435], abs=25)
