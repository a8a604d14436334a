"""Reads a video file as stamped pictures, each on request."""

import logging
from collections.abc import Generator
from functools import cache
from pathlib import Path

import cv2
import numpy as np

from actum.node import SECOND_NS
from sensor_gateway.captured_picture import Picture

MILLISECOND_NS = SECOND_NS // 1000
USUAL_RATE_HZ = 25.0
"""Frame rate assumed for files with neither stamps nor a rate, such as bare H.264 streams."""
WHOLE = 0.9
"""Share of a file's duration that its frames fill, if none is missing: sound may last a little longer."""
SUFFIXES = frozenset({".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm", ".wmv"})

log = logging.getLogger("actum")


class VideoError(ValueError):
    """A file holds no readable pictures; the message names the file and the remedy."""


def pictures_of(path: Path, start_ns: int = 0) -> Generator[Picture, None, None]:
    """Yield a file's frames; the first is stamped `start_ns`, later ones by the file's own times.

    Where those times do not rise, as in a bare H.264 stream or at some files' end, a frame is stamped one interval
    after the last. Where frames are missing at the end of the file, that is logged.

    Raises:
        VideoError: the file cannot be read as a video, or holds no frame.
    """
    capture = cv2.VideoCapture(str(path))
    try:
        first_ns = newest_ns = None
        while (grabbed := capture.read())[0]:
            at_ns = round(capture.get(cv2.CAP_PROP_POS_MSEC) * MILLISECOND_NS)
            first_ns = at_ns if first_ns is None else first_ns
            stamp_ns = start_ns + at_ns - first_ns
            if newest_ns is not None and stamp_ns <= newest_ns:
                rate_hz = capture.get(cv2.CAP_PROP_FPS)
                stamp_ns = newest_ns + round(SECOND_NS / (rate_hz if rate_hz > 0 else USUAL_RATE_HZ))
            newest_ns = stamp_ns
            yield Picture(grabbed[1].astype(np.uint8, copy=False), stamp_ns)
        if first_ns is None:
            raise VideoError(
                f"{path} is not a video that OpenCV can read: convert the video, for example to .mp4 with H.264"
            )
        assert newest_ns is not None
        _check_end(path, (newest_ns - start_ns) / SECOND_NS, _end_s(capture))
    finally:
        capture.release()


def _end_s(capture: cv2.VideoCapture) -> float:
    """Return how long after its first frame a file says that its last one comes (s); 0 or less if it does not say."""
    rate_hz = capture.get(cv2.CAP_PROP_FPS)
    return (capture.get(cv2.CAP_PROP_FRAME_COUNT) - 1) / rate_hz if rate_hz > 0 else 0.0


@cache
def _check_end(path: Path, read_s: float, end_s: float) -> None:
    """Warn, once for each file, where the last frame that can be read comes long before the file's end."""
    if read_s < WHOLE * end_s:
        log.warning("%s should last %.1f s, but its images end after %.1f s: copy the file again", path, end_s, read_s)


def frame_count(path: Path) -> int:
    """Return how many frames a file says that it has; 0 where it does not say, or is no video."""
    capture = cv2.VideoCapture(str(path))
    try:
        return max(0, round(capture.get(cv2.CAP_PROP_FRAME_COUNT)))
    finally:
        capture.release()
