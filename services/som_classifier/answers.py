"""The messages in which the classifier answers."""

import math
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from actum.messages import AUTO, Action, HeldBack, Posture, Segment, Tensor, WhyHeldBack
from som_classifier.frames import Stretch, missing_joints
from som_classifier.model import Recognition
from som_classifier.segments import ClosedSegment, OpenSegment
from som_classifier.spotting.spotted import Ongoing

WHY_HELD_BACK: Mapping[WhyHeldBack, str] = {
    "unknown": "like {}, but not like enough",
    "disabled": "{} is switched off in the settings",
    "pause": "{} follows the action before it too soon for the setting shortest_pause_s",
    "cooldown": "{} follows the one before it too soon for the setting cooldown_s",
    "unanswerable": "perhaps {}, but with too few usable frames to recognise",
}
"""The reasons in words; `{}` stands for the action."""


def partial_action(segment: OpenSegment, recognition: Recognition, seen: Stretch, posture: Posture) -> Action:
    """Say what an open segment shows so far, at a posture's instant."""
    assert segment.start_ns is not None
    build = Action.of_checked if math.isfinite(recognition.confidence) else Action  # which refuses what is not finite
    return build(
        stamp_ns=posture.stamp_ns,
        sensor=posture.sensor,
        agent=posture.agent,
        segment_id=segment.segment_id,
        start_ns=segment.start_ns,
        end_ns=None,
        final=False,
        **_recognised_fields(recognition),
        frames=len(seen.usable),
        missed=seen.missed,
        hand=segment.hand,
        missing_joints=seen.missing_joints,
        session_id=posture.session_id,
    )


def ongoing_action(segment_id: str, ongoing: Ongoing, seen: Stretch, posture: Posture) -> Action:
    """Say what seems to be going on though nobody marked it, at a posture's instant."""
    return Action.of_checked(
        stamp_ns=posture.stamp_ns,
        sensor=posture.sensor,
        agent=posture.agent,
        segment_id=segment_id,
        start_ns=ongoing.start_ns,
        end_ns=None,
        final=False,
        action=ongoing.label,
        confidence=ongoing.confidence,
        activations={},
        part=None,
        frames=len(seen.usable),
        missed=seen.missed,
        missing_joints=seen.missing_joints,
        completeness=ongoing.completeness,
        session_id=posture.session_id,
    )


def final_action(
    closed: ClosedSegment, recognition: Recognition | None, reason: str | None, sensor: str, **more: Any
) -> Action:
    """Answer a segment: with what was recognised, or with the reason why it is rejected.

    Args:
        closed: the segment.
        recognition: None where there is none.
        reason: None where there is none.
        sensor: the viewpoint.
        more: the field `session_id`, and `maps` and `trace` where they are wanted.
    """
    return Action(
        stamp_ns=closed.end_ns,
        sensor=sensor,
        valid=reason is None,
        reason=reason,
        agent=closed.agent,
        segment_id=closed.segment_id,
        start_ns=closed.start_ns,
        end_ns=closed.end_ns,
        final=True,
        **_recognised_fields(recognition),
        frames=len(closed.usable),
        missed=closed.missed,
        hand=closed.hand,
        unknown=recognition.unknown if recognition else False,
        familiarity=recognition.familiarity if recognition else None,
        missing_joints=missing_joints(closed.frames),
        **more,
    )


def held_back(
    closed: ClosedSegment, action: str, recognition: Recognition | None, why: WhyHeldBack, sensor: str, session_id: str
) -> HeldBack:
    """Say of a segment that was found that it is not published as `action`, and why."""
    familiarity = None if recognition is None else recognition.familiarity
    exactly = f": {familiarity:.2f}" if why == "unknown" and familiarity is not None else ""
    return HeldBack(
        stamp_ns=closed.end_ns,
        sensor=sensor,
        agent=closed.agent,
        start_ns=closed.start_ns,
        end_ns=closed.end_ns,
        action=action,
        confidence=0.0 if recognition is None else recognition.confidence,
        familiarity=familiarity,
        why=why,
        sentence=WHY_HELD_BACK[why].format(action) + exactly,
        session_id=session_id,
    )


def own_mark(kind: Literal["start", "end"], closed: ClosedSegment, sensor: str) -> Segment:
    """Mark one end of a segment that was found without marks."""
    stamp_ns = closed.start_ns if kind == "start" else closed.end_ns
    return Segment(
        stamp_ns=stamp_ns, sensor=sensor, kind=kind, segment_id=closed.segment_id, agent=closed.agent, origin=AUTO
    )


def tensor(array: NDArray[Any]) -> Tensor:
    """Return an array as a message carries it."""
    little = np.ascontiguousarray(array, dtype="<f4")
    return Tensor(dtype="<f4", shape=list(little.shape), data=little.tobytes())


def _recognised_fields(recognition: Recognition | None) -> dict[str, Any]:
    if recognition is None:
        return {"action": None, "confidence": 0.0, "activations": {}, "part": None}
    return {
        "action": recognition.label,
        "confidence": recognition.confidence,
        "activations": recognition.activations,
        "part": recognition.part,
    }
