"""Which frames can be used: none with repeated, non-finite, coincident or absurd joints, or without a trunk."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.geometry import BONES
from actum.messages import Joint
from actum.skeletons import JOINTS

_PARENTS = np.array([parent for parent, _, _ in BONES])
_CHILDREN = np.array([child for _, child, _ in BONES])
_NEEDED = frozenset({"torso", "neck"})
_PAIRS = (frozenset({"left_hip", "right_hip"}), frozenset({"left_shoulder", "right_shoulder"}))
_UNKNOWN = [math.nan] * 3


class BadFrameError(ValueError):
    """A frame that cannot be used; `kind` is the name it is counted under."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(detail)
        self.kind = kind


def missing_joints(joints: list[Joint]) -> list[int]:
    """Tell which joints the source lacks."""
    return [index for index, joint in enumerate(joints) if joint is None]


def as_array(joints: list[Joint]) -> NDArray[np.float64]:
    """Return joints as an array of shape (15, 3), NaN where one is missing."""
    return np.array([_UNKNOWN if joint is None else joint for joint in joints], dtype=np.float64)


def check(array: NDArray[np.float64], missing: Sequence[int], reach_limit_m: float, bone_limit_m: float) -> None:
    """Refuse joints (15, 3), camera frame, metres, that cannot be used.

    Args:
        missing: which of them are not known; the others must be finite.

    Raises:
        BadFrameError: of kind `missing_joint` (no torso, no neck, or neither both hips nor both shoulders),
            `not_finite`, `absurd_joint` or `absurd_bone`.
    """
    if missing:
        _require_trunk([JOINTS[index] for index in missing])
    if not (np.abs(array) <= reach_limit_m).all():
        _require_near(array, missing, reach_limit_m)
    bones = array[_CHILDREN] - array[_PARENTS]
    lengths2 = np.einsum("ij,ij->i", bones, bones)
    if np.fmax.reduce(lengths2) > bone_limit_m**2:
        child = JOINTS[int(_CHILDREN[int(np.nanargmax(lengths2))])]
        raise BadFrameError("absurd_bone", f"the bone to {child} is longer than {bone_limit_m:g} m")


def _require_trunk(missing: Sequence[str]) -> None:
    if not _NEEDED.isdisjoint(missing) or not any(pair.isdisjoint(missing) for pair in _PAIRS):
        raise BadFrameError("missing_joint", f"no {', '.join(missing)}")


def _require_near(array: NDArray[np.float64], missing: Sequence[int], reach_limit_m: float) -> None:
    given = [i for i in range(len(JOINTS)) if i not in missing]
    for i in given:
        if not np.isfinite(array[i]).all():
            raise BadFrameError("not_finite", f"{JOINTS[i]} is not a finite position")
    for i in given:
        if np.abs(array[i]).max() > reach_limit_m:
            raise BadFrameError("absurd_joint", f"{JOINTS[i]} is more than {reach_limit_m:g} m away")
