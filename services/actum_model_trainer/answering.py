"""A model's answers to samples, computed by the live classifier's code but without messages in between."""

from collections.abc import Sequence

import numpy as np

from actum_model_trainer.samples import SegmentSample
from som_classifier.frames import Frame
from som_classifier.kinematics import Kinematics
from som_classifier.model import Model, Recognition


def encoded(model: Model, sample: SegmentSample) -> list[Frame]:
    """Return a sample's frames, each with the activity that the model's encoder gives it."""
    encoder, frames = model.encoder(), []
    for index, stamp_ns in enumerate(sample.stamps_ns):
        kinematics = Kinematics(sample.postures[index], sample.velocities[index])
        missing = tuple(np.flatnonzero(np.isnan(kinematics.posture[:, 0])).tolist())
        joints, motion = sample.joints[index], sample.motion[index]
        frame = Frame(int(stamp_ns), None, (), 0, 0.0, joints, motion, kinematics, missing)
        frame.activity = encoder.encode(frame)
        frames.append(frame)
    return frames


def answer(model: Model, frames: Sequence[Frame], fraction: float = 1.0) -> Recognition:
    """Return the model's answer to the first share (0 to 1) of a sample's encoded frames; 1 is the complete action."""
    count = min(len(frames), max(model.min_frames, round(fraction * len(frames))))
    return model.recognise(frames[:count], complete=fraction >= 1.0)
