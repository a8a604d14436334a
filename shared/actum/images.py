"""Decode image messages; refuse unusable images before memory is allocated for them.

Needs OpenCV and imagesize, which the extra `marker-tracker` brings.
"""

import io
import struct

import cv2
import imagesize
import numpy as np

from actum.arrays import Pixels
from actum.messages import Image
from actum.pictures import MOST_SCANS, has_too_many_scans, is_black

LARGEST_PIXELS = 4096 * 4096
"""Pixels of an image: several times what a colour camera gives."""
JPEG_START = b"\xff\xd8"
"""The bytes that begin every JPEG: the marker "start of image"."""


class UnusableImageError(ValueError):
    """An image that cannot be used; `kind` is the name of the counter of such rejects."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(f"{kind}: {detail}")
        self.kind = kind
        self.detail = detail


def gray(image: Image) -> Pixels:
    """Decode an image message to grey levels (height, width).

    Raises:
        UnusableImageError: of kind `image_too_large`, `image_size_mismatch` or `undecodable_image`.
    """
    if image.format == "jpeg":
        return _from_jpeg(image, cv2.IMREAD_GRAYSCALE)
    return cv2.cvtColor(_raw(image), cv2.COLOR_BGR2GRAY).astype(np.uint8, copy=False)


def colour(image: Image) -> Pixels:
    """Decode an image message to blue, green and red levels (height, width, 3).

    Raises:
        UnusableImageError: as `gray`.
    """
    return _from_jpeg(image, cv2.IMREAD_COLOR) if image.format == "jpeg" else _raw(image)


def _refuse_large(image: Image) -> None:
    if image.width * image.height > LARGEST_PIXELS:
        raise UnusableImageError(
            "image_too_large",
            f"the image has {image.width}x{image.height} pixels; at most {LARGEST_PIXELS} pixels in all are allowed: "
            "send a smaller image",
        )


def _raw(image: Image) -> Pixels:
    """Return the pixels (height, width, 3) of an image in the format bgr8."""
    _refuse_large(image)
    expected = image.width * image.height * 3
    if len(image.data) != expected:
        raise UnusableImageError(
            "image_size_mismatch",
            f"the image has {len(image.data)} bytes, but {image.width}x{image.height} pixels in the format bgr8 need "
            f"{expected} bytes: correct the fields width and height, or send all bytes",
        )
    return np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.width, 3)


def refuse_black(pixels: Pixels) -> None:
    """Refuse a black image (height, width): its lack of markers does not mean that there are no objects.

    Raises:
        UnusableImageError: of kind `black_image`.
    """
    if is_black(pixels):
        raise UnusableImageError("black_image", "the image is black: uncover the lens, or switch on the light")


def _from_jpeg(image: Image, flags: int) -> Pixels:
    """Decode a JPEG after its header has been checked: decoding allocates as much as the header claims."""
    _refuse_large(image)
    size = _jpeg_size(image.data)
    if size[0] * size[1] > LARGEST_PIXELS:
        raise UnusableImageError(
            "image_too_large",
            f"the JPEG has {size[0]}x{size[1]} pixels; at most {LARGEST_PIXELS} pixels in all are allowed: send a "
            "smaller image",
        )
    if size != (image.width, image.height):
        raise UnusableImageError(
            "image_size_mismatch",
            f"the JPEG has {size[0]}x{size[1]} pixels, but the image message gives {image.width}x{image.height}: set "
            "the fields width and height of the message to the size of the JPEG",
        )
    if has_too_many_scans(image.data):
        raise UnusableImageError(
            "image_too_large", f"the JPEG has more than {MOST_SCANS} scans: send a JPEG that is not progressive"
        )
    pixels = cv2.imdecode(np.frombuffer(image.data, dtype=np.uint8), flags | cv2.IMREAD_IGNORE_ORIENTATION)
    if pixels is None or pixels.shape[:2] != (image.height, image.width):
        raise UnusableImageError(
            "undecodable_image", f"the JPEG of {len(image.data)} bytes is damaged or incomplete: send a whole JPEG file"
        )
    return pixels.astype(np.uint8, copy=False)


def _jpeg_size(data: bytes) -> tuple[int, int]:
    """Read (width, height) from a JPEG's header."""
    if not data.startswith(JPEG_START):
        raise UnusableImageError(
            "undecodable_image",
            f"the image message has the format jpeg, but its {len(data)} bytes do not start with FF D8 as every "
            "JPEG does: send a JPEG file, or set the format to bgr8 for raw pixels",
        )
    try:
        width, height = imagesize.get(io.BytesIO(data), exif_rotation=False)
    except (ValueError, struct.error) as error:
        raise UnusableImageError(
            "undecodable_image", f"the header of the JPEG is damaged ({error}): send a whole JPEG file"
        ) from None
    if width <= 0 or height <= 0:
        raise UnusableImageError(
            "undecodable_image",
            f"the header of the JPEG ({len(data)} bytes) gives no image size: send a whole JPEG file",
        )
    return width, height
