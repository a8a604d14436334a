"""What gateways can be told to read in tests, as their arguments."""

from pathlib import Path

import numpy as np

from actum import geometry
from actum.calibration import Calibration
from actum.messages import Message
from actum.recorder import write_recording
from camera_videos import write_video

SIZE = (64, 48)


def marker_camera(folder: Path, video: Path | None = None) -> list[str]:
    """Play a video again and again as a camera beside the one that sees the people."""
    calibration = folder / "beside.yaml"
    intrinsics = [60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0]
    aside = geometry.flat(np.eye(4))
    Calibration(image_size=SIZE, K=intrinsics, distortion=[], skeleton_from_image=aside).save(calibration)
    played = video or write_video(folder / "a.avi", size=SIZE)
    return ["--source", "marker-camera", "--calibration", str(calibration), "--camera", str(played), "--loop"]


def recording(path: Path, *messages: Message) -> list[str]:
    """Play messages as a recording."""
    write_recording(path, messages, person="1", source="test")
    return ["--source", "recording", "--path", str(path)]
