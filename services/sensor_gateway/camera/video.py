"""A video file as stamped pictures, at no pace of its own."""

from collections.abc import Generator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS

MILLISECOND_NS = SECOND_NS // 1000
USUAL_RATE_HZ = 25.0
SUFFIXES = frozenset({".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm", ".wmv"})


class VideoError(ValueError):
    """A file that is no video: which and what to do."""


@dataclass(frozen=True, eq=False)
class Picture:
    """One captured image (height, width, 3), BGR, and the capture's stamp."""

    image_bgr: NDArray[np.uint8]
    stamp_ns: int


def unmirrored(picture: Picture) -> Picture:
    """Turn a mirror image back: in it the actor's left would be their right, and no marker could be read."""
    return replace(picture, image_bgr=np.ascontiguousarray(picture.image_bgr[:, ::-1]))


def pictures_of(path: Path, start_ns: int = 0) -> Generator[Picture, None, None]:
    """Yield a file's frames; the first is stamped `start_ns`, the others by the file's own times.

    Where those do not rise, as in a bare H.264 stream or at some files' end, a frame comes one interval after the last.

    Raises:
        VideoError: it cannot be read as a video, or holds no frame.
    """
    capture = cv2.VideoCapture(str(path))
    try:
        first_ns = newest_ns = None
        while (grabbed := capture.read())[0]:
            at_ns = round(capture.get(cv2.CAP_PROP_POS_MSEC) * MILLISECOND_NS)
            first_ns = at_ns if first_ns is None else first_ns
            stamp_ns = start_ns + at_ns - first_ns
            if newest_ns is not None and stamp_ns <= newest_ns:
                stamp_ns = newest_ns + _interval_ns(capture)
            newest_ns = stamp_ns
            yield Picture(grabbed[1].astype(np.uint8, copy=False), stamp_ns)
        if first_ns is None:
            raise VideoError(f"{path}: no video that OpenCV can read; convert it, for example to .mp4 with H.264")
    finally:
        capture.release()


def _interval_ns(capture: cv2.VideoCapture) -> int:
    """Return the time between two frames at the rate that the file tells, or the usual one."""
    per_second = capture.get(cv2.CAP_PROP_FPS)
    return round(SECOND_NS / (per_second if per_second > 0 else USUAL_RATE_HZ))
