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
from recognisers import tiny_model
from som_classifier.continuation import HORIZONS_S, Continuation
from som_classifier.frames import Frame
from som_classifier.kinematics import LAG_TIME_CONSTANT_S
from som_classifier.model import Model
from som_classifier.pyramid_model import PyramidModel
from som_classifier.regressed_continuation import ANSWERS, INPUTS, RegressedContinuation
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


@cache
def at_this_speed() -> PyramidModel:
    """A tiny model after which every joint goes on from where it is measured, at the speed that it has."""
    model = tiny_model()
    assert isinstance(model, PyramidModel)
    moves = INPUTS // 2
    axes = np.zeros((INPUTS + model.first.units, moves), np.float32)
    axes[moves:INPUTS] = np.eye(moves) / LAG_TIME_CONSTANT_S
    directions = np.concatenate([ahead_s * np.eye(moves) for ahead_s in HORIZONS_S], axis=1).astype(np.float32)
    none, shares = np.zeros(INPUTS, np.float32), np.ones((2, len(HORIZONS_S)), np.float32)
    continuation = RegressedContinuation(none, axes, directions, np.zeros(ANSWERS, np.float32), shares)
    return replace(model, continuation=continuation)


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
