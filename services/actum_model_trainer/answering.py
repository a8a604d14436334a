"""A model's answers to samples, through the same code as live, without messages between."""

from collections.abc import Sequence

from actum_model_trainer.samples import SegmentSample
from som_classifier.frames import Frame
from som_classifier.kinematics import Kinematics
from som_classifier.model import Model
from som_classifier.recognition import Recognition


def encoded(model: Model, sample: SegmentSample) -> list[Frame]:
    """Return a sample's frames as the model remembers them."""
    encoder = model.encoder()
    frames = [_frame(sample, index) for index in range(len(sample.stamps_ns))]
    for frame in frames:
        frame.activity = encoder.encode(frame)
    return frames


def answer(model: Model, frames: Sequence[Frame], fraction: float = 1.0) -> Recognition:
    """Return what the model says after a share of a sample's frames; at 1 it knows that the segment has ended."""
    count = min(len(frames), max(model.min_frames, round(fraction * len(frames))))
    return model.recognise(frames[:count], complete=fraction >= 1.0)


def _frame(sample: SegmentSample, index: int) -> Frame:
    movement = Kinematics(sample.postures[index], sample.velocities[index])
    return Frame(
        int(sample.stamps_ns[index]), None, (), 0, 0.0, sample.joints[index], sample.motion[index], movement,
        tuple((movement.posture[:, 0] != movement.posture[:, 0]).nonzero()[0].tolist()),
    )  # fmt: skip
