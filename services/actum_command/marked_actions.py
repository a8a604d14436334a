"""The marked actions of recordings as training gets them, which `actum takes` lists."""

from collections.abc import Iterator
from dataclasses import dataclass

from actum.node import SECOND_NS
from actum.recording import Recording
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, sensors, why_unusable
from som_classifier.segments import ClosedSegment


@dataclass(frozen=True)
class MarkedAction:
    """One marked action: its number of valid frames, and why it cannot be trained on, None where it can."""

    sensor: str
    segment_id: str
    label: str | None
    duration_s: float
    frames: int
    problem: str | None


def marked_actions(recording: Recording) -> Iterator[MarkedAction]:
    """Yield a recording's marked actions as training would get them.

    Raises:
        RecordingError: the file is damaged.
    """
    for sensor in sensors(recording):
        for closed in closed_segments(classifier_input(recording, sensor)):
            yield MarkedAction(
                sensor,
                closed.segment_id,
                closed.label,
                (closed.end_ns - closed.start_ns) / SECOND_NS,
                sum(frame.valid for frame in closed.frames),
                _problem(closed),
            )


def _problem(closed: ClosedSegment) -> str | None:
    """Return why a segment cannot be trained on, None where it can."""
    problem = why_unusable(closed)
    return "no label" if problem is None and closed.label is None else problem
