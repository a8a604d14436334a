"""What pictures say in words."""

from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.text_layout import shortened


def headline(answered: AnsweredSegment) -> str:
    """Say what was done and what it was taken for: `push: 41 frames, recognised push 0.93`."""
    done = shortened(answered.label) if answered.label is not None else "an action without a label"
    return f"{done}: {len(answered.frames)} frames, {verdict(answered)}"


def verdict(answered: AnsweredSegment) -> str:
    """Say what a segment was taken for."""
    if answered.recognition is None:
        return "rejected"
    found, confidence = answered.recognition.label, answered.recognition.confidence
    taken = "recognised" if answered.label is None or answered.correct else "taken for"
    unsure = " (unfamiliar)" if answered.recognition.unknown else ""
    return f"{taken} {shortened(found)} {confidence:.2f}{unsure}"
