"""The segments of recordings with what a model says of each."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from actum.recording import Recording
from actum_model_inspector.anatomy import Anatomy
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.samples import classifier_input, closed_segments, sensors
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.recognition import Recognition
from som_classifier.segments import ClosedSegment


@dataclass(frozen=True, eq=False)
class Answered:
    """A segment and the model's answer.

    Attributes:
        label: what was done, None where the recording does not say.
        frames: its valid frames, not encoded.
        recognition: None where it was rejected.
        place: its unit on the second map, None where it was rejected.
    """

    file: str
    person: str
    segment_id: str
    label: str | None
    frames: Sequence[Frame]
    recognition: Recognition | None = None
    place: int | None = None

    @property
    def correct(self) -> bool:
        """Whether the answer is the label."""
        return self.recognition is not None and self.recognition.label == self.label

    @property
    def shares(self) -> NDArray[np.float64]:
        """How far through the segment's time each frame lies, 0 to 1, shape (n,)."""
        stamps = np.array([frame.stamp_ns for frame in self.frames], dtype=np.float64)
        shares: NDArray[np.float64] = (stamps - stamps[0]) / max(stamps[-1] - stamps[0], 1.0)
        return shares


def answered_segments(anatomy: Anatomy, recordings: Sequence[Recording], progress: Progress = silent) -> list[Answered]:
    """Cut every segment out of the recordings, labelled or not, and let the model answer it.

    Raises:
        RecordingError: a file is damaged.
    """
    answered = []
    for done, recording in enumerate(recordings):
        progress("recognising segments", done, len(recordings))
        for sensor in sensors(recording):
            closed = closed_segments(classifier_input(recording, sensor))
            answered += [_answered(anatomy, recording, segment) for segment in closed]
    progress("recognising segments", len(recordings), len(recordings))
    return answered


def encoded(model: Model, frames: Sequence[Frame]) -> list[Frame]:
    """Return valid frames as the model remembers them."""
    encoder = model.encoder()
    return [replace(frame, activity=encoder.encode(frame)) for frame in frames]


def _answered(anatomy: Anatomy, recording: Recording, closed: ClosedSegment) -> Answered:
    valid = [frame for frame in closed.frames if frame.valid]
    unanswered = Answered(str(recording.path), recording.person, closed.segment_id, closed.label, valid)
    if closed.reason or len(valid) < anatomy.model.min_frames:
        return unanswered
    frames = encoded(anatomy.model, valid)
    recognition = anatomy.model.recognise(frames, complete=True)
    return replace(unanswered, recognition=recognition, place=anatomy.place(frames))
