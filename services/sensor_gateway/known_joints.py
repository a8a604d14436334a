"""The joints of a person that count as known, by their confidence."""

from collections.abc import Sequence

from actum.messages import Joint
from actum.skeletons import INDEX

TRUNK = frozenset({INDEX["neck"], INDEX["torso"]})
"""Joints that always count as known: every posture is expressed relative to them."""
LEAST_CONFIDENCE = 0.1
"""Least confidence of a known joint: below it, its position is a guess of the detector."""


def known_joints(joints: Sequence[Joint], confidence: Sequence[float]) -> list[Joint]:
    """Return the joints (15), with None for each one whose confidence (15) is too low, except neck and torso."""
    return [
        joint if score >= LEAST_CONFIDENCE or i in TRUNK else None
        for i, (joint, score) in enumerate(zip(joints, confidence, strict=True))
    ]
