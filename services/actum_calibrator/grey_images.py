"""Decodes image files to grey levels; refuses huge and damaged ones before memory is allocated."""

import io
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import imagesize
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Pixels
from actum.pictures import MOST_SCANS, has_too_many_scans

LARGEST_PIXELS = 10_000 * 10_000  # 100 MB of grey levels; no camera has more


class UnusablePictureError(ValueError):
    """A picture that cannot be used for calibration: `name` is its name, the message gives the reason."""

    def __init__(self, name: str, problem: str) -> None:
        super().__init__(f"{name}: {problem}")
        self.name = name


class BlurredError(UnusablePictureError):
    """A picture too blurred to calibrate with."""


def read_grey(path: Path) -> Pixels:
    """Read an image file as grey levels of shape (height, width).

    Raises:
        UnusablePictureError: the file cannot be read, is no image, or is too large.
    """
    try:
        return decode_grey(path.read_bytes(), path.name)
    except OSError as error:
        raise UnusablePictureError(
            path.name, f"the file cannot be read ({error.strerror}): correct its name or permissions"
        ) from None


def decode_grey(data: bytes, name: str) -> Pixels:
    """Decode an image, its header first, to grey levels (height, width); `name` is used in errors.

    Raises:
        UnusablePictureError: the data are no image, damaged or too large.
    """
    try:
        width, height = imagesize.get(io.BytesIO(data), exif_rotation=False)
    except (ValueError, struct.error):
        width, height = -1, -1
    if width <= 0 or height <= 0:
        raise UnusablePictureError(name, "the file is not an image: use a picture file such as .png or .jpg")
    if width * height > LARGEST_PIXELS:
        raise UnusablePictureError(
            name, f"the image is {width}x{height}; at most {LARGEST_PIXELS} pixels are allowed: use a smaller image"
        )
    if has_too_many_scans(data):
        raise UnusablePictureError(
            name, f"the JPEG has more than {MOST_SCANS} scans: save the picture again as a baseline JPEG"
        )
    pixels = _decoded(data)
    if pixels is None:
        raise UnusablePictureError(name, "the image is damaged: take the picture again")
    return pixels.astype(np.uint8, copy=False)


def _decoded(data: bytes) -> NDArray[Any] | None:
    flags = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        return cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error:  # OpenCV refuses the size in the header
        return None


def complaints(unusable: Sequence[UnusablePictureError]) -> list[str]:
    """Sum up in sentences how many pictures are unusable, why, and what to do."""
    blurred = sum(isinstance(error, BlurredError) for error in unusable)
    others = len(unusable) - blurred
    sentences = []
    if blurred:
        sentences.append(f"{_pictures(blurred)} blurred: hold the board still, use more light, or focus the lens")
    if others:
        sentences.append(
            f"{_pictures(others)} without a usable board: check that the board is the one that --board, "
            "--square-mm, --marker-mm and --family describe, and that it is close, entirely visible and without "
            "glare"
        )
    return sentences


def _pictures(count: int) -> str:
    return "1 picture is" if count == 1 else f"{count} pictures are"
