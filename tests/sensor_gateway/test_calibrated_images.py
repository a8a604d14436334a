"""A calibration file replaces what a source says of its camera, for images of its size only."""

from pathlib import Path

import numpy as np
import pytest

from actum.calibration import Calibration, CalibrationError
from actum.messages import Image, Skeleton
from sensor_gateway.settings import Settings
from sensor_gateway.sources import source_of

K = [500.0, 0.0, 321.0, 0.0, 501.0, 239.0, 0.0, 0.0, 1.0]
SHIFTED = np.eye(4)
SHIFTED[0, 3] = 0.12


def calibration(width: int = 640) -> Calibration:
    return Calibration(
        image_size=(width, 480), K=K, distortion=[0.1, 0, 0, 0, 0],
        skeleton_from_image=SHIFTED.ravel().tolist(),
    )  # fmt: skip


def first_frames(
    recording: Path, calibration_file: Path | None
) -> tuple[list[Image], list[Skeleton], dict[str, int], dict[str, str]]:
    source = source_of(Settings(source="recording", path=recording, calibration=calibration_file), 0)
    frames = source.frames()
    messages = [message for _ in range(5) for message in next(frames)]
    images = [message for message in messages if isinstance(message, Image)]
    skeletons = [message for message in messages if isinstance(message, Skeleton)]
    return images, skeletons, dict(source.counters.rejects), source.counters.details


def test_images_carry_the_calibration_and_skeletons_are_as_they_were(tmp_path: Path, recorded_scene: Path) -> None:
    calibration().save(tmp_path / "camera.yaml")
    images, skeletons, rejects, details = first_frames(recorded_scene, tmp_path / "camera.yaml")
    plain_images, plain_skeletons, _, _ = first_frames(recorded_scene, None)
    assert images and [image.data for image in images] == [image.data for image in plain_images]
    assert all(image.K == K and image.skeleton_from_image == SHIFTED.ravel().tolist() for image in images)
    assert skeletons == plain_skeletons
    assert not rejects and details["calibration"] == calibration().id


def test_an_image_of_another_size_is_counted_and_invalid(tmp_path: Path, recorded_scene: Path) -> None:
    calibration(width=1280).save(tmp_path / "camera.yaml")
    images, _, rejects, _ = first_frames(recorded_scene, tmp_path / "camera.yaml")
    assert rejects == {"image_size_mismatch": len(images)}
    assert not any(image.valid for image in images)
    assert "640x480, calibrated for 1280x480" in str(images[0].reason)


def test_a_missing_file_is_an_error_that_names_it(tmp_path: Path, recorded_scene: Path) -> None:
    with pytest.raises(CalibrationError, match="nowhere.yaml"):
        source_of(Settings(source="recording", path=recorded_scene, calibration=tmp_path / "nowhere.yaml"), 0)
