"""The segments of recordings, each with a model's answer."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array
from actum.messages import is_action
from actum.recording import Recording
from actum_model_inspector.text_layout import shortened
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, sensors
from som_classifier.frames import Frame
from som_classifier.model import Model, Recognition
from som_classifier.model_maps import maps_of
from som_classifier.segments import ClosedSegment


@dataclass(frozen=True, eq=False)
class AnsweredSegment:
    """A segment and the model's answer to it.

    Attributes:
        file: the recording's path.
        person: who acts, as the recording names them.
        segment_id: of the segment in the recording.
        label: the action done, None where the recording does not say.
        frames: the valid frames, not encoded.
        recognition: the answer, None where the segment was rejected.
        action_unit: its winner on the second map, None where it was rejected or the model has no maps.
    """

    file: str
    person: str
    segment_id: str
    label: str | None
    frames: Sequence[Frame]
    recognition: Recognition | None = None
    action_unit: int | None = None

    @property
    def correct(self) -> bool:
        """Whether the answer is the label."""
        return self.recognition is not None and self.recognition.label == self.label

    @property
    def relative_times(self) -> Array:
        """The time of each frame, from 0 at the segment's first to 1 at its last, shape (n,)."""
        stamps_ns = np.array([frame.stamp_ns for frame in self.frames], dtype=np.float64)
        relative: Array = (stamps_ns - stamps_ns[0]) / max(stamps_ns[-1] - stamps_ns[0], 1.0)
        return relative


def answered_segments(
    model: Model, recordings: Sequence[Recording], progress: Progress = silent
) -> list[AnsweredSegment]:
    """Cut every segment out of the recordings, labelled or not, and return each with the model's answer.

    Raises:
        RecordingError: a file is damaged.
    """
    answered = []
    for done, recording in enumerate(recordings):
        progress("recognising segments", done, len(recordings))
        for sensor in sensors(recording):
            closed = closed_segments(classifier_input(recording, sensor))
            answered += [_answered(model, recording, segment) for segment in closed]
    progress("recognising segments", len(recordings), len(recordings))
    return answered


def encoded(model: Model, frames: Sequence[Frame]) -> list[Frame]:
    """Return valid frames, each with the activity that the model's encoder gives it."""
    encoder = model.encoder()
    return [replace(frame, activity=encoder.encode(frame)) for frame in frames]


def _answered(model: Model, recording: Recording, closed: ClosedSegment) -> AnsweredSegment:
    valid = [frame for frame in closed.frames if frame.valid]
    label = closed.label if is_action(closed.label) else None
    unanswered = AnsweredSegment(str(recording.path), recording.person, closed.segment_id, label, valid)
    if closed.reason or len(valid) < model.min_frames:
        return unanswered
    frames, maps = encoded(model, valid), maps_of(model)
    unit = None if maps is None else maps.action_unit(frames)
    return replace(unanswered, recognition=model.recognise(frames, complete=True), action_unit=unit)


def headline(answered: AnsweredSegment) -> str:
    """State the action done and the answer: `push: 41 frames, recognised push 0.93`."""
    done = shortened(answered.label) if answered.label is not None else "an action without a label"
    return f"{done}: {len(answered.frames)} frames, {_verdict(answered)}"


def _verdict(answered: AnsweredSegment) -> str:
    if answered.recognition is None:
        return "rejected"
    label, confidence = answered.recognition.label, answered.recognition.confidence
    taken = "recognised" if answered.label is None or answered.correct else "taken for"
    unsure = " (unfamiliar)" if answered.recognition.unknown else ""
    return f"{taken} {shortened(label)} {confidence:.2f}{unsure}"
