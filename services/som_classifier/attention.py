"""Attention: which of the five body parts to look at, chosen from motion alone (paper, section 2.1)."""

import numpy as np
from numpy.typing import NDArray

from actum.skeletons import PARTS
from actum.som import Som

PART_NAMES: tuple[str, ...] = tuple(PARTS)
UNSEEN = -1
"""The winner for a part none of whose joints is there."""
_PART_JOINTS = np.array(list(PARTS.values()))


def attended(motion: NDArray[np.float64], fixed: str | None = None, there: NDArray[np.bool_] | None = None) -> int:
    """Return the index of the part that moves most over a segment, or of the fixed one; ties by listed order.

    A part that is never there is not attended to while another is.

    Args:
        motion: (n, 5), each part's displacement (m) since the frame before. The first row is motion from
            before the segment and does not count.
        fixed: a name of `skeletons.PARTS`, or None to choose.
        there: (5,), which parts have a joint in some frame; all where None.
    """
    if fixed is not None and (there is None or there[PART_NAMES.index(fixed)]):
        return PART_NAMES.index(fixed)
    moved = motion[1:].sum(axis=0)
    return int(np.argmax(moved if there is None else np.where(there, moved, -1.0)))


def winners(layer1: Som, joints: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the map's winner for each part, shape (5,), `UNSEEN` where a part has no joint, from joints (15, 3).

    One matrix product of always the same shape, so that live and replayed frames agree to the bit.
    """
    inputs = part_inputs(joints)
    if np.isfinite(inputs).all():
        return layer1.bmus(inputs)
    found = np.full(len(inputs), UNSEEN, dtype=np.intp)
    partly = ~np.isnan(inputs).all(axis=1)
    found[partly] = layer1.bmus(inputs[partly])
    return found


def part_inputs(joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the first layer's input of each part, shape (5, 9), from one frame's joints (15, 3)."""
    inputs: NDArray[np.float64] = joints[_PART_JOINTS].reshape(len(PART_NAMES), -1)
    return inputs
