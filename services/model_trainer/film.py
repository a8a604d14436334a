"""Films of examples: the bodies as the recogniser gets them, and their way over the posture map."""

from dataclasses import dataclass

import numpy as np

from actum import keys
from actum.arrays import Array
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_model_trainer.recorded_segments import classifier_input, closed_segments
from som_classifier.frames import Frame
from som_classifier.model import Model

MOST_HZ = 15
"""Most pictures of a film in a second: enough to see what is done."""
EARLY_NS = SECOND_NS // 100
"""How much sooner a picture may come (ns): cameras of 30 Hz are not exact."""


@dataclass(frozen=True, eq=False)
class Film:
    """One example.

    Attributes:
        stamps_ns: (k,), of its pictures.
        joints: (k, 15, 3), upright frame, m, of the standard body; NaN where missing.
        trace: (n, 2), rows and columns of the posture map; None without a model.
    """

    stamps_ns: tuple[int, ...]
    joints: Array
    trace: Array | None


def films_of(recording: Recording, model: Model | None) -> dict[str, Film]:
    """Return the film of each segment of a take that has a usable frame, by the segment's id.

    Raises:
        RecordingError: the file is damaged.
    """
    films: dict[str, Film] = {}
    for sensor in recording.sensors(keys.SEGMENT):
        for closed in closed_segments(classifier_input(recording, sensor)):
            frames = [frame for frame in closed.frames if frame.valid]
            if frames:
                films.setdefault(closed.segment_id, _film(frames, model))
    return films


def _film(frames: list[Frame], model: Model | None) -> Film:
    pictures: list[Frame] = []
    for frame in frames:
        if not pictures or frame.stamp_ns - pictures[-1].stamp_ns >= SECOND_NS / MOST_HZ - EARLY_NS:
            pictures.append(frame)
    joints = np.array([frame.kinematics.posture for frame in pictures if frame.kinematics is not None])
    trace = None
    if model is not None and len(frames) >= model.min_frames:
        encoder = model.encoder()
        for frame in frames:
            frame.activity = encoder.encode(frame)
        trace = model.trace(frames)
    return Film(tuple(frame.stamp_ns for frame in pictures), joints, trace)
