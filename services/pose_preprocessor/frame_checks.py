"""Refuses frames that cannot be used: those with non-finite or absurd joints, or without a trunk."""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum.skeletons import JOINTS
from actum.standard_body import BONES, bones_of

_CHILDREN = [child for _, child, _ in BONES]
_NEEDED = frozenset({"torso", "neck"})
"""No egocentric frame is defined without them, nor without one of the pairs below."""
_PAIRS = (frozenset({"left_hip", "right_hip"}), frozenset({"left_shoulder", "right_shoulder"}))


class BadFrameError(ValueError):
    """A frame that cannot be used; `kind` is the name it is counted under."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(detail)
        self.kind = kind


def check_frame(joints: Array, missing: Sequence[int], reach_limit_m: float, bone_limit_m: float) -> None:
    """Check that a frame's joints can be used.

    Args:
        joints: (15, 3), camera frame, metres.
        missing: which of them are not known; the others must be finite.
        reach_limit_m: a joint further away than this along any camera axis is absurd.
        bone_limit_m: a longer bone is absurd.

    Raises:
        BadFrameError: of kind `missing_joint` (no torso, no neck, or neither both hips nor both shoulders),
            `not_finite`, `absurd_joint` or `absurd_bone`.
    """
    if missing:
        names = [JOINTS[index] for index in missing]
        if not _NEEDED.isdisjoint(names) or not any(pair.isdisjoint(names) for pair in _PAIRS):
            raise BadFrameError(
                "missing_joint",
                f"the skeleton lacks the joints {', '.join(names)}: let the camera see the person's trunk",
            )
    if not (np.abs(joints) <= reach_limit_m).all():
        known = {joint: joints[i] for i, joint in enumerate(JOINTS) if i not in missing}
        for joint, place_m in known.items():
            if not np.isfinite(place_m).all():
                raise BadFrameError(
                    "not_finite",
                    f"a coordinate of the joint {joint} is NaN or infinite: publish null for a joint that is not known",
                )
        for joint, place_m in known.items():
            if np.abs(place_m).max() > reach_limit_m:
                raise BadFrameError(
                    "absurd_joint",
                    f"the joint {joint} is more than {reach_limit_m:g} m from the camera, the limit that the setting "
                    "reach_limit_m gives: publish joints in metres",
                )
    _, lengths2 = bones_of(joints)
    if np.fmax.reduce(lengths2) > bone_limit_m**2:
        child = JOINTS[_CHILDREN[int(np.nanargmax(lengths2))]]
        raise BadFrameError(
            "absurd_bone",
            f"the bone that ends at the joint {child} is longer than {bone_limit_m:g} m, the limit that the setting "
            "bone_limit_m gives: publish joints in metres, in the order of joint_names",
        )
