"""Which frames can be used: no missing, repeated, non-finite, coincident or absurd joints."""

import numpy as np
from numpy.typing import NDArray

from actum.geometry import BONES
from actum.messages import Joint
from actum.skeletons import JOINTS

_PARENTS = np.array([parent for parent, _, _ in BONES])
_CHILDREN = np.array([child for _, child, _ in BONES])


class BadFrameError(ValueError):
    """A frame that cannot be used; `kind` is the name it is counted under."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(detail)
        self.kind = kind


def measured(joints: list[Joint], reach_limit_m: float, bone_limit_m: float) -> NDArray[np.float64]:
    """Return usable joints as an array of shape (15, 3), camera frame, metres.

    Raises:
        BadFrameError: of kind `missing_joint`, `not_finite`, `absurd_joint` or `absurd_bone`.
    """
    missing = [name for name, joint in zip(JOINTS, joints, strict=True) if joint is None]
    if missing:
        raise BadFrameError("missing_joint", f"no {', '.join(missing)}")
    array = np.array(joints, dtype=np.float64)
    if not (np.abs(array) <= reach_limit_m).all():
        raise _beyond(array, reach_limit_m)
    bones = array[_CHILDREN] - array[_PARENTS]
    lengths2 = np.einsum("ij,ij->i", bones, bones)
    if lengths2.max() > bone_limit_m**2:
        child = JOINTS[int(_CHILDREN[int(np.argmax(lengths2))])]
        raise BadFrameError("absurd_bone", f"the bone to {child} is longer than {bone_limit_m:g} m")
    return array


def _beyond(array: NDArray[np.float64], reach_limit_m: float) -> BadFrameError:
    finite = np.isfinite(array).all(axis=1)
    if not finite.all():
        return BadFrameError("not_finite", f"{_first(~finite)} is not a finite position")
    far = (np.abs(array) > reach_limit_m).any(axis=1)
    return BadFrameError("absurd_joint", f"{_first(far)} is more than {reach_limit_m:g} m away")


def _first(bad: NDArray[np.bool_] | np.bool_) -> str:
    return JOINTS[int(np.argmax(bad))]
