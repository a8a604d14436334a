"""Our recogniser: finding actions by itself through the live nodes, and given the true segments."""

from collections.abc import Callable
from functools import partial

from actum_model_trainer.answering import encoded
from actum_model_trainer.continuous.detections import Detection
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.training import train_to_spot
from som_classifier.model import Model
from som_classifier.presets import DEFAULT

from .methods import SEED, Method
from .streams import Stream

ModelOf = Callable[[tuple[Stream, ...]], Model]

OURS = "actum"


def trained(training: tuple[Stream, ...]) -> Model:
    """Train the default preset on streams."""
    samples = [sample for stream in training for sample in stream.taught.usable]
    return train_to_spot(samples, [each for stream in training for each in stream.taught.streams], DEFAULT, SEED)


def ours(model_of: ModelOf) -> Method:
    """Return the default preset, which finds actions by itself."""
    return Method(OURS, lambda training: partial(replayed, model_of(training)))


def replayed(model: Model, stream: Stream) -> list[Detection]:
    """Replay the recording without its marks through preprocessor and classifier."""
    return list(found_by(model, [stream.recording]).detections)


def bound(model_of: ModelOf) -> Method:
    """Return the default preset on the true segments: what is left to gain."""
    return Method("true segments, then our classifier (bound)", lambda training: partial(told, model_of(training)))


def told(model: Model, stream: Stream) -> list[Detection]:
    """Answer the true segments."""
    frames = encoded(model, stream.whole)
    detections = []
    for first, last in map(stream.frames_of, stream.truths):
        if last - first + 1 >= model.min_frames:
            answer = model.recognise(frames[first : last + 1], complete=True)
            detections.append(stream.answered(first, last, last, answer))
    return detections
