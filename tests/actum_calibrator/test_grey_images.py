import struct
import zlib

import cv2
import numpy as np
import pytest

from actum.messages import Image
from actum_calibrator.grey_images import UnusablePictureError, decode_grey, grey_from_message, read_grey

GREY = np.tile(np.arange(64, dtype=np.uint8) * 4, (48, 1))
EYE = np.eye(4).ravel().tolist()


def encoded(ending: str) -> bytes:
    return cv2.imencode(ending, GREY)[1].tobytes()


def huge_png() -> bytes:
    """A header that claims 30,000 x 30,000 pixels."""
    header = b"IHDR" + struct.pack(">IIBBBBB", 30_000, 30_000, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))


def long_bmp() -> bytes:
    """A header that claims 2,000,000 x 10 pixels."""
    sizes = struct.pack("<IiiHHIIiiII", 40, 2_000_000, 10, 1, 24, 0, 0, 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54, 0, 0, 54) + sizes


def message(**fields) -> Image:
    known = {"stamp_ns": 0, "sensor": "k", "format": "jpeg", "width": 64, "height": 48, "data": encoded(".jpg")}
    return Image.model_validate(known | {"K": [1.0] * 9, "distortion": [], "skeleton_from_image": EYE} | fields)


@pytest.mark.parametrize("ending", [".png", ".jpg", ".bmp"])
def test_a_file_is_read_as_grey(tmp_path, ending: str) -> None:
    (tmp_path / f"a{ending}").write_bytes(encoded(ending))
    assert np.abs(read_grey(tmp_path / f"a{ending}").astype(int) - GREY).max() <= 3


def test_both_formats_of_a_message_are_read() -> None:
    colours = cv2.cvtColor(GREY, cv2.COLOR_GRAY2BGR).tobytes()
    assert (grey_from_message(message(format="bgr8", data=colours), "a") == GREY).all()
    assert grey_from_message(message(), "a").shape == GREY.shape


@pytest.mark.parametrize("data", [b"", b"text", encoded(".png")[:60], huge_png(), long_bmp()])
def test_what_is_no_picture_is_named(data: bytes) -> None:
    with pytest.raises(UnusablePictureError, match=r"a\.png: the (file|image) is "):
        decode_grey(data, "a.png")


@pytest.mark.parametrize("fields", [{"width": 63}, {"format": "bgr8"}, {"format": "depth16_mm"}, {"data": b"\xff\xd8"}])
def test_a_message_that_contradicts_itself_is_named(fields) -> None:
    with pytest.raises(UnusablePictureError, match="image 1"):
        grey_from_message(message(**fields), "image 1")


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(UnusablePictureError, match=r"no\.png: the file cannot be read: No such file"):
        read_grey(tmp_path / "no.png")
