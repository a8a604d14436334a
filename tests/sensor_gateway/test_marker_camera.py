"""A camera beside the one that sees the people puts images that say where it is, and nothing of people."""

from pathlib import Path

import numpy as np
import pytest

from actum import geometry
from actum.calibration import Calibration, CalibrationError
from actum.messages import Image, Message
from camera_videos import write_video
from sensor_gateway.settings import Settings
from sensor_gateway.sources import source_of

SIZE = (64, 48)
HALF_A_METRE_ASIDE = geometry.flat(np.array([[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]))


def calibration(folder: Path, size: tuple[int, int] = SIZE, aside: list[float] | None = HALF_A_METRE_ASIDE) -> Path:
    path = folder / f"{size[0]}.yaml"
    Calibration(
        image_size=size, K=[60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0], distortion=[], skeleton_from_image=aside
    ).save(path)
    return path


def told(folder: Path, **settings: object) -> tuple[list[Message], dict[str, int]]:
    video = write_video(folder / "clip.avi", size=SIZE)
    chosen = {"source": "marker-camera", "camera": str(video), "calibration": calibration(folder)} | settings
    source = source_of(Settings(**chosen), start_ns=1)  # type: ignore[arg-type]
    messages = [message for instant in source.frames() for message in instant]
    return messages, dict(source.counters.rejects)


def test_its_images_say_where_the_peoples_camera_is(tmp_path: Path) -> None:
    messages, rejects = told(tmp_path)
    assert len(messages) == 6
    assert all(isinstance(message, Image) for message in messages)
    assert {tuple(message.skeleton_from_image) for message in messages if isinstance(message, Image)} == {
        tuple(HALF_A_METRE_ASIDE)
    }
    assert rejects == {}


def test_images_of_another_size_than_was_calibrated_are_counted(tmp_path: Path) -> None:
    messages, rejects = told(tmp_path, calibration=calibration(tmp_path, (128, 96)))
    assert (messages, rejects) == ([], {"image_size_mismatch": 6})


def test_a_lost_one_says_nothing_of_the_people(tmp_path: Path) -> None:
    chosen = {"source": "marker-camera", "camera": str(tmp_path / "none.avi"), "calibration": calibration(tmp_path)}
    source = source_of(Settings(**chosen), start_ns=1)  # type: ignore[arg-type]
    frames = source.frames()
    assert [next(frames) for _ in range(3)] == [[], [], []]
    assert source.counters.state.startswith("camera lost")


@pytest.mark.parametrize("aside", [None, "no file"])
def test_it_must_know_where_it_is(tmp_path: Path, aside: str | None) -> None:
    path = None if aside else calibration(tmp_path, aside=None)
    with pytest.raises(CalibrationError, match="actum calibrate extrinsics"):
        source_of(Settings(source="marker-camera", calibration=path), start_ns=1)


def test_the_peoples_gateway_can_leave_the_images_to_it(recorded_scene: Path) -> None:
    source = source_of(Settings(source="recording", path=recorded_scene, images=False), start_ns=0)
    kinds = {
        type(message).__name__ for _, instant in zip(range(40), source.frames(), strict=False) for message in instant
    }
    assert "Skeleton" in kinds
    assert "Image" not in kinds
