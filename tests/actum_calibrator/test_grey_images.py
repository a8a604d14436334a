import struct
import zlib

import cv2
import numpy as np
import pytest

from actum_calibrator.grey_images import UnusablePictureError, decode_grey, read_grey

GREY = np.tile(np.arange(64, dtype=np.uint8) * 4, (48, 1))


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


@pytest.mark.parametrize("ending", [".png", ".jpg", ".bmp"])
def test_a_file_is_read_as_grey(tmp_path, ending: str) -> None:
    (tmp_path / f"a{ending}").write_bytes(encoded(ending))
    assert np.abs(read_grey(tmp_path / f"a{ending}").astype(int) - GREY).max() <= 3


@pytest.mark.parametrize("data", [b"", b"text", encoded(".png")[:60], huge_png(), long_bmp()])
def test_what_is_no_picture_is_named(data: bytes) -> None:
    with pytest.raises(UnusablePictureError, match=r"a\.png: the (file|image) is "):
        decode_grey(data, "a.png")


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(
        UnusablePictureError, match=r"no\.png: the file cannot be read \(No such file or directory\): correct"
    ):
        read_grey(tmp_path / "no.png")
