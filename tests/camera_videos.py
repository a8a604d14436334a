"""Small videos made for tests."""

from pathlib import Path

import cv2
import numpy as np

FRAMES_PER_SECOND = 10


def write_video(path: Path, frames: int = 6, size: tuple[int, int] = (64, 48)) -> Path:
    """Write grey pictures that grow lighter: the first has level 20, each next one ten more."""
    path.parent.mkdir(parents=True, exist_ok=True)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), FRAMES_PER_SECOND, size)
    assert writer.isOpened()
    for i in range(frames):
        writer.write(np.full((size[1], size[0], 3), 20 + 10 * i, np.uint8))
    writer.release()
    return path
