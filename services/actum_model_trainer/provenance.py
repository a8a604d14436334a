"""The metadata of a model that describe its training: samples, preset, seed and version."""

import hashlib
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

import actum
from actum_model_trainer.samples import LabelledStream, SegmentSample
from som_classifier.presets import Preset


class TrainingError(ValueError):
    """No model can be trained on these samples."""


class KeptError(TrainingError):
    """What a model keeps of its training is missing, damaged or another model's: no example can be added to it."""


def actions_of(samples: Sequence[SegmentSample]) -> list[str]:
    """List the actions among the samples, sorted.

    Raises:
        TrainingError: there are fewer than two.
    """
    labels = sorted({sample.label for sample in samples})
    if len(labels) < 2:
        examples = f"examples of only one action, {labels[0]!r}" if labels else "no usable examples"
        raise TrainingError(
            f"a model needs examples of at least two actions, but the recordings contain {examples}: record more "
            "actions"
        )
    return labels


def provenance(samples: Sequence[SegmentSample], preset: Preset, seed: int) -> dict[str, Any]:
    """Return those fields of a model's metadata that every kind of model has."""
    return {
        "labels": actions_of(samples),
        "preset": preset.name,
        "parameters": asdict(preset),
        "seed": seed,
        "persons": sorted({sample.person for sample in samples if sample.person}),
        "samples": len(samples),
        "data_digest": digest_of(samples),
        "actum_version": actum.__version__,
    }


def digest_of(samples: Sequence[SegmentSample]) -> str:
    """Return the SHA-256 (hexadecimal) over all fields of the samples that a training reads, in their order."""
    digest = hashlib.sha256()
    for sample in samples:
        digest.update(f"{sample.label}\0{sample.person}\0{sample.joints.shape}\0{sample.depth_inferred}".encode())
        for values in (sample.stamps_ns, sample.joints, sample.motion, sample.postures, sample.velocities):
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def digest_of_streams(streams: Sequence[LabelledStream]) -> str:
    """Return the SHA-256 (hexadecimal) over all fields of streams that a training reads, in their order."""
    digest = hashlib.sha256()
    for stream in streams:
        digest.update(f"{stream.segments}\0{stream.person}\0{stream.depth_inferred}".encode())
        for values in (stream.stamps_ns, stream.motion, stream.postures, stream.velocities):
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()
