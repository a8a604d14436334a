"""Finds pictures that are black."""

import numpy as np
from numpy.typing import NDArray

BLACK_LEVEL = 10
"""A picture is black where the 99th percentile of its levels (0 to 255) is no higher than this."""
STEP_PX = 8
"""Spacing (px) of the pixels that are sampled: a percentile needs no more."""


def is_black(pixels: NDArray[np.uint8]) -> bool:
    """Tell whether a picture (height, width) or (height, width, channels) is too dark to show anything."""
    return bool(np.percentile(pixels[::STEP_PX, ::STEP_PX], 99) <= BLACK_LEVEL)
