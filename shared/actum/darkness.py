"""Whether a picture shows anything."""

import numpy as np
from numpy.typing import NDArray

BLACK_LEVEL = 10
"""The 99th percentile of a picture in which nothing can be seen, of 255."""
STEP_PX = 8
"""Every so many pixels (px) are looked at: a percentile needs no more."""


def is_black(pixels: NDArray[np.uint8]) -> bool:
    """Tell whether nothing can be seen in a picture (height, width) or (height, width, channels)."""
    return bool(np.percentile(pixels[::STEP_PX, ::STEP_PX], 99) <= BLACK_LEVEL)
