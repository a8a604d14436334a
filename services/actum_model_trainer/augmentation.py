"""Each sample seen from other sides, and as people of other proportions and tempos would have done it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.geometry import BONES
from actum.skeletons import JOINTS
from actum_model_trainer.samples import SegmentSample
from som_classifier.handedness import mirrored
from som_classifier.presets import PyramidPreset

Array = NDArray[np.float64]

_BONE_NAMES = sorted({JOINTS[child].removeprefix("left_").removeprefix("right_") for _, child, _ in BONES})


@dataclass(frozen=True, eq=False)
class View:
    """A sample as it is shown: (n, 15, 3) postures and velocities."""

    postures: Array
    velocities: Array

    @property
    def mirrored(self) -> "View":
        """The same in a mirror."""
        return View(mirrored(self.postures), mirrored(self.velocities))

    def until(self, frames: int) -> "View":
        """Return the first frames alone."""
        return View(self.postures[:frames], self.velocities[:frames])


def views(sample: SegmentSample, preset: PyramidPreset, mirrors: bool, rng: np.random.Generator) -> Iterator[View]:
    """Yield the sample itself, then turned, then as other people; where `mirrors`, the left arm's in a mirror."""
    seen = View(sample.postures, sample.velocities)
    own = seen.mirrored if mirrors and sample.acting_hands[-1] == "left" else seen
    yield own
    for turn_deg, lean_deg in zip(preset.turns_deg, preset.leans_deg, strict=True):
        turn = turned(np.radians(turn_deg)) @ leant(np.radians(lean_deg if sample.depth_inferred else 0.0))
        yield View(own.postures @ turn, own.velocities @ turn)
    for _ in range(preset.others.count):
        factors = np.exp(rng.normal(0.0, preset.others.build_sd, len(_BONE_NAMES)))
        build = rebuilt(dict(zip(_BONE_NAMES, factors, strict=True)))
        yield View(_applied(build, own.postures), preset.others.tempo * _applied(build, own.velocities))


def turned(radians: float) -> Array:
    """Return what turns row vectors (left, up, forward) about the vertical, shape (3, 3)."""
    cos, sin = np.cos(radians), np.sin(radians)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])


def leant(radians: float) -> Array:
    """Return what tilts row vectors (left, up, forward) back about the line from left to right, shape (3, 3)."""
    cos, sin = np.cos(radians), np.sin(radians)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])


def rebuilt(factors: dict[str, float]) -> Array:
    """Return what lengthens each bone by its factor, shape (15, 15), for joints relative to the torso.

    A bone is named after the joint at its end, without its side: both sides change alike.
    """
    build = np.zeros((len(JOINTS), len(JOINTS)))
    for parent, child, _ in BONES:
        factor = factors[JOINTS[child].removeprefix("left_").removeprefix("right_")]
        build[child] = build[parent]
        build[child, child] += factor
        build[child, parent] -= factor
    return build


def _applied(build: Array, vectors: Array) -> Array:
    """Apply a build to (n, 15, 3); a missing joint stays missing and is nobody else's concern."""
    return np.where(np.isnan(vectors), np.nan, build @ np.nan_to_num(vectors))
