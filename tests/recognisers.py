"""Small trained models for tests that need a classifier and not a good one."""

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

from actum.recorder import write_recording
from actum.recording import Recording
from actum.skeletons import PARTS
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from performers import HAND_PATHS, TINY, performance
from som_classifier.handedness import mirrored
from som_classifier.model import Model
from som_classifier.presets import Preset

OTHER_SIDE = [list(PARTS).index(name) for name in ("left_arm", "right_arm", "left_leg", "right_leg", "body")]


@cache
def tiny_model(preset: Preset = TINY) -> Model:
    """Train on two synthetic people, of whom the one who swings does so with the left arm; every action twice."""
    return train(tiny_samples(), preset)


@cache
def tiny_samples() -> tuple[SegmentSample, ...]:
    skeletons, marks = performance([*HAND_PATHS] * 2)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "performance.mcap"
        write_recording(path, [*skeletons, *marks], person="1", source="test")
        samples = samples_from([Recording(path)]).usable
    return tuple(replace(sample, person="left-handed" if sample.label == "swing" else "1") for sample in samples)


def in_a_mirror(sample: SegmentSample) -> SegmentSample:
    """Return what the sample's mirror image would have done."""
    return replace(
        sample,
        postures=mirrored(sample.postures),
        velocities=mirrored(sample.velocities),
        motion=sample.motion[:, OTHER_SIDE],
    )
