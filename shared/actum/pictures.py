"""Checks of pictures before they are looked at: black ones, and JPEGs that cost far more to decode than their size."""

import numpy as np
from numpy.typing import NDArray

BLACK_LEVEL = 10
"""A picture is black where the 99th percentile of its levels (0 to 255) is no higher than this."""
STEP_PX = 8
"""Spacing (px) of the pixels that are sampled: a percentile needs no more."""
SCAN = b"\xff\xda"
"""The marker "start of scan", which the coded pixels never hold."""
MOST_SCANS = 64
"""Most scans of an image: progressive JPEGs have about ten. Each decodes all pixels anew, and may take 30 bytes."""


def is_black(pixels: NDArray[np.uint8]) -> bool:
    """Tell whether a picture (height, width) or (height, width, channels) is too dark to show anything."""
    return bool(np.percentile(pixels[::STEP_PX, ::STEP_PX], 99) <= BLACK_LEVEL)


def has_too_many_scans(jpeg: bytes) -> bool:
    """Tell whether decoding a JPEG would take many times as long as an image of its size should."""
    return jpeg.count(SCAN) > MOST_SCANS
