"""Which of a person's joints are passed on as known."""

from collections.abc import Sequence

from actum.messages import Joint
from actum.skeletons import INDEX

TRUNK = frozenset({INDEX["neck"], INDEX["torso"]})
"""Always passed on: every posture is expressed relative to them."""
LEAST_CONFIDENCE = 0.1
"""Below it a joint's place is a guess of the detector's."""


def known_joints(joints: Sequence[Joint], confidence: Sequence[float]) -> list[Joint]:
    """Return the joints (15), None for those of too little confidence (15) except neck and torso."""
    return [
        joint if sure >= LEAST_CONFIDENCE or i in TRUNK else None
        for i, (joint, sure) in enumerate(zip(joints, confidence, strict=True))
    ]
