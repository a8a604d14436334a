"""Attention: which of the five body parts to look at, chosen from motion alone (paper, section 2.1)."""

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import PARTS

PART_NAMES: tuple[str, ...] = tuple(PARTS)
_PART_JOINTS = np.array(list(PARTS.values()))


def attended(motion: NDArray[np.float64], fixed: str | None = None) -> int:
    """Return the index of the part that moves most over a segment, or of the fixed one; ties by listed order.

    Args:
        motion: (n, 5), each part's displacement (m) since the frame before. The first row is motion from
            before the segment and does not count.
        fixed: a name of `skeletons.PARTS`, or None to choose.
    """
    if fixed is not None:
        return PART_NAMES.index(fixed)
    return int(np.argmax(motion[1:].sum(axis=0)))


def part_inputs(joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the first layer's input of each part, shape (5, 9), from one frame's joints (15, 3)."""
    inputs: NDArray[np.float64] = joints[_PART_JOINTS].reshape(len(PART_NAMES), -1)
    return inputs
