"""The errors of postures predicted ahead, of a model and of two assumptions that need none."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.skeletons import JOINTS
from som_classifier.continuation import HORIZONS_S
from som_classifier.frames import Frame
from som_classifier.kinematics import GAP_NS, LAG_TIME_CONSTANT_S
from som_classifier.model import Model

Array = NDArray[np.float64]
EVERY_NS = SECOND_NS // 5
"""Time between two frames from which is predicted (ns)."""
FIRST_NS = SECOND_NS // 4
"""Time after a stream's first frame before which nothing is predicted (ns): the low-pass has no velocity yet."""
KEPT = 16
"""Frames that a continuation is given, half a second at 30 Hz."""
Predict = Callable[[Sequence[Frame]], Array]
"""Returns the postures (3, 15, 3) after `HORIZONS_S`, from frames of which the last is the newest."""
Truth = Callable[[Frame], Array]
"""Returns a frame's posture (15, 3), which predictions are compared with."""


def as_measured(frame: Frame) -> Array:
    """Return the posture as measured."""
    assert frame.upright is not None
    return frame.upright


def as_smoothed(frame: Frame) -> Array:
    """Return the posture as the classifier smooths it."""
    assert frame.kinematics is not None
    return frame.kinematics.posture


def errors_of(predict: Predict, streams: Sequence[Sequence[Frame]], truth: Truth) -> Array:
    """Return the mean distance of joints from where they are later (m), (3,), over one person's streams."""
    summed, count = np.zeros(len(HORIZONS_S)), np.zeros(len(HORIZONS_S))
    for frames in streams:
        stamps_ns = np.array([frame.stamp_ns for frame in frames])
        for newest in starts(stamps_ns):
            truths = truths_after(frames, stamps_ns, newest, truth)
            known = ~np.isnan(truths).any(axis=(1, 2))
            if known.any():
                answer = predict(frames[max(newest + 1 - KEPT, 0) : newest + 1])
                summed[known] += np.linalg.norm(answer[known] - truths[known], axis=2).mean(axis=1)
                count += known
    return summed / count


def predicting(model: Model, streams: Sequence[Sequence[Frame]]) -> Predict:
    """Return what a model predicts, after giving all frames the activity that its encoder computes."""
    assert model.continuation is not None
    for frames in streams:
        encoder = model.encoder()
        for frame in frames:
            frame.activity = encoder.encode(frame)
    return model.continuation.ahead


def stays_as_measured(frames: Sequence[Frame]) -> Array:
    """Return the newest posture as measured, thrice."""
    return np.tile(as_measured(frames[-1]), (len(HORIZONS_S), 1, 1))


def stays_as_smoothed(frames: Sequence[Frame]) -> Array:
    """Return the newest posture as the classifier smooths it, thrice."""
    return np.tile(as_smoothed(frames[-1]), (len(HORIZONS_S), 1, 1))


def goes_on_at_its_speed(frames: Sequence[Frame]) -> Array:
    """Return the postures that are reached at the velocity that the classifier estimates."""
    kinematics = frames[-1].kinematics
    assert kinematics is not None
    moved: Array = np.array(HORIZONS_S)[:, None, None] * kinematics.velocity / LAG_TIME_CONSTANT_S
    return kinematics.posture + moved


BASELINES: Mapping[str, Predict] = {
    "stays as measured": stays_as_measured,
    "stays as smoothed": stays_as_smoothed,
    "goes on at this speed": goes_on_at_its_speed,
}


def starts(stamps_ns: NDArray[np.int64]) -> Iterator[int]:
    """Yield the frames from which is predicted."""
    due_ns = stamps_ns[0] + FIRST_NS if len(stamps_ns) else 0
    for number, stamp_ns in enumerate(stamps_ns.tolist()):
        if stamp_ns >= due_ns:
            due_ns = stamp_ns + EVERY_NS
            yield number


def truths_after(frames: Sequence[Frame], stamps_ns: NDArray[np.int64], newest: int, truth: Truth) -> Array:
    """Return the true postures (3, 15, 3) after each horizon, interpolated; NaN where the stream ends or breaks."""
    truths = np.full((len(HORIZONS_S), len(JOINTS), 3), np.nan)
    for horizon, horizon_s in enumerate(HORIZONS_S):
        at_ns = stamps_ns[newest] + round(horizon_s * SECOND_NS)
        after = int(np.searchsorted(stamps_ns, at_ns))
        if after == len(frames) or np.diff(stamps_ns[newest : after + 1]).max() > GAP_NS:
            break
        earlier, later = truth(frames[after - 1]), truth(frames[after])
        share = (at_ns - stamps_ns[after - 1]) / (stamps_ns[after] - stamps_ns[after - 1])
        truths[horizon] = earlier + share * (later - earlier)
    return truths
