"""Small models that also predict how postures go on, one of each kind."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.training import train, with_continuation
from performers import TINY_PAPER
from som_classifier.continuation import Continuation
from som_classifier.frames import Frame
from som_classifier.model import Model
from unmarked import spotting_model, taught

FROM_TORSO = replace(TINY_PAPER, posture=replace(TINY_PAPER.posture, origin="torso"))
KINDS = ("paper", "pyramid")


@cache
def without_continuation(kind: str) -> Model:
    return train(taught().usable, FROM_TORSO) if kind == "paper" else spotting_model()


@cache
def continued(kind: str) -> Model:
    return with_continuation(without_continuation(kind), taught().streams)


def continuation_of(model: Model) -> Continuation:
    assert model.continuation is not None
    return model.continuation


def standing_stream(posture: Array, seconds: float = 10.0, person: str = "1") -> LabelledStream:
    """Somebody of whom nothing moves, at 30 Hz."""
    count = round(30 * seconds)
    stamps_ns = np.arange(count) * (SECOND_NS // 30)
    postures = np.tile(posture, (count, 1, 1))
    return LabelledStream(stamps_ns, np.zeros((count, 5)), postures, np.zeros_like(postures), (), person, "still", 1)


def postures_at(frames: Sequence[Frame], stamps_ns: Sequence[int]) -> Array:
    """Return the measured postures nearest to some stamps, (n, 15, 3)."""
    known = np.array([frame.stamp_ns for frame in frames])
    nearest = [frames[int(np.abs(known - stamp_ns).argmin())] for stamp_ns in stamps_ns]
    return np.stack([frame.upright for frame in nearest if frame.upright is not None])
