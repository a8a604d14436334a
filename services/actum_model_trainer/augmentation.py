"""Data augmentation: variants of each sample, rotated and with the proportions and tempos of other bodies."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum.arrays import Array, Indices, Mask
from actum.skeletons import JOINTS
from actum.standard_body import BONES
from actum_model_trainer.samples import SegmentSample
from som_classifier.handedness import mirrored
from som_classifier.presets import PyramidPreset

_BONE_OF_JOINT = [joint.removeprefix("left_").removeprefix("right_") for joint in JOINTS]
"""The name of the bone that ends in each joint; both sides of the body have the same."""
_BONE_NAMES = sorted({_BONE_OF_JOINT[child] for _, child, _ in BONES})


@dataclass(frozen=True, eq=False)
class Variant:
    """A sample as measured, or an augmented version of it, which is worked out each time that it is asked for.

    Attributes:
        measured: (n, 15, 3) twice: postures in metres to the left, up and forward from the torso, and velocities of the
            same joints.
        turn: (3, 3), rotates row vectors; None where nothing is turned.
        scaling: (15, 15), changes the bones' lengths; None where these stay.
        tempo: by which velocities are multiplied.
    """

    measured: tuple[Array, Array]
    turn: Array | None = None
    scaling: Array | None = None
    tempo: float = 1.0

    @property
    def postures(self) -> Array:
        """The postures, (n, 15, 3)."""
        return self._changed(self.measured[0])

    @property
    def velocities(self) -> Array:
        """The velocities, (n, 15, 3)."""
        changed = self._changed(self.measured[1])
        return changed if self.tempo == 1.0 else self.tempo * changed

    @property
    def mirrored(self) -> "Variant":
        """Its mirror image, left and right exchanged."""
        return Variant((mirrored(self.postures), mirrored(self.velocities)))

    def some(self, frames: Mask | Indices) -> "Variant":
        """Return some of its frames, by a mask (n,) or by their numbers."""
        return replace(self, measured=(self.measured[0][frames], self.measured[1][frames]))

    def _changed(self, vectors: Array) -> Array:
        if self.turn is not None:
            return vectors @ self.turn
        return vectors if self.scaling is None else _applied(self.scaling, vectors)


def augmentation_for(people: Sequence[str], preset: PyramidPreset) -> PyramidPreset:
    """Return the preset whose augmentation suits the people of all samples: few show less of how bodies differ."""
    return replace(preset, others=preset.others_of_few) if len(set(people)) <= preset.few_people else preset


def variants(
    sample: SegmentSample, preset: PyramidPreset, mirrors: bool, rng: np.random.Generator
) -> Iterator[Variant]:
    """Yield the sample as measured, then rotated, then with other bodies' proportions and tempo.

    Args:
        sample: the sample to vary.
        preset: gives the rotations and the variation of bodies.
        mirrors: whether a sample of the left arm is mirrored first, as the classifier reads it.
        rng: draws the proportions.
    """
    measured = Variant((sample.postures, sample.velocities))
    as_read = measured.mirrored if mirrors and sample.acting_hands[-1] == "left" else measured
    yield from varied(as_read, sample.depth_inferred, preset, rng)


def varied(
    measured: Variant, depth_inferred: bool, preset: PyramidPreset, rng: np.random.Generator
) -> Iterator[Variant]:
    """Yield postures and velocities as measured, then rotated, then with other bodies' proportions and tempo."""
    yield measured
    own = measured.postures, measured.velocities
    for yaw_deg, pitch_deg in zip(preset.turns_deg, preset.leans_deg, strict=True):
        pitch = pitch_rotation(np.radians(pitch_deg if depth_inferred else 0.0))
        yield Variant(own, turn=yaw_rotation(np.radians(yaw_deg)) @ pitch)
    for _ in range(preset.others.count):
        factors = np.exp(rng.normal(0.0, preset.others.build_sd, len(_BONE_NAMES)))
        scaling = bone_scaling(dict(zip(_BONE_NAMES, factors, strict=True)))
        yield Variant(own, scaling=scaling, tempo=preset.others.tempo)


def yaw_rotation(radians: float) -> Array:
    """Return the matrix (3, 3) that rotates row vectors (left, up, forward) about the vertical: vectors @ matrix."""
    cos, sin = np.cos(radians), np.sin(radians)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])


def pitch_rotation(radians: float) -> Array:
    """Return the matrix (3, 3) that tilts row vectors (left, up, forward) back, about the axis to the left."""
    cos, sin = np.cos(radians), np.sin(radians)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])


def bone_scaling(factors: dict[str, float]) -> Array:
    """Return the matrix (15, 15) that multiplies joints (15, 3) from the torso so that bone lengths scale by factors.

    A bone is named after the joint at its end, without its side: both sides scale alike. Directions stay.
    """
    scaling = np.zeros((len(JOINTS), len(JOINTS)))
    for parent, child, _ in BONES:
        factor = factors[_BONE_OF_JOINT[child]]
        scaling[child] = scaling[parent]
        scaling[child, child] += factor
        scaling[child, parent] -= factor
    return scaling


def _applied(scaling: Array, vectors: Array) -> Array:
    """Scale vectors (n, 15, 3); a missing joint stays missing and affects no other."""
    if not np.isnan(vectors).any():
        return scaling @ vectors
    return np.where(np.isnan(vectors), np.nan, scaling @ np.nan_to_num(vectors))
