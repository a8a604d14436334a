"""Synthetic people who do some actions and then other things, and a small model that finds actions without marks."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from actum.messages import Segment, Skeleton
from actum.recorder import write_recording
from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train_to_spot
from people import FRAME_NS, STANDING, skeleton
from performers import HAND_PATHS, TINY, performance
from som_classifier.pyramid_model import PyramidModel


def fidgeting(frames: int, first: int) -> list[Skeleton]:
    """Somebody who shifts from one foot to the other, and now and then moves a hand a little."""
    moved = np.zeros((frames, 15, 3))
    moved[:, :, 0] = 0.05 * np.sin(np.arange(frames) / 9)[:, None]
    moved[:, 8] += 0.25 * np.clip(np.sin(np.arange(frames) / 20), 0, 1)[:, None] * np.array([0.2, -1.0, -0.4])
    return [skeleton((first + i) * FRAME_NS, STANDING + moved[i]) for i in range(frames)]


def day(seed: int) -> list[Skeleton | Segment]:
    """Every action twice, then half a minute and more of other doings."""
    skeletons, marks = performance([*HAND_PATHS] * 2, seed=seed)
    return [*skeletons, *fidgeting(1000, len(skeletons)), *marks]


def days(folder: Path) -> list[Recording]:
    """Write recordings of persons 1, 2 and 3."""
    files = [folder / f"day{n}.mcap" for n in (1, 2, 3)]
    for n, file in enumerate(files, start=1):
        write_recording(file, day(n), person=str(n), source="test")
    return [Recording(file) for file in files]


def searching_model(recordings: Sequence[Recording]) -> PyramidModel:
    """Train a model; its thresholds are said to give other rates of false alarms than they do with such people."""
    samples = samples_from(recordings)
    trained = train_to_spot(samples.usable, samples.streams, TINY)
    assert isinstance(trained, PyramidModel)
    learned = trained.metadata.spotting
    assert learned is not None
    rates = {"thresholds": [0.02, 0.2, 0.3, 0.8], "threshold": 0.02, "false_alarms_per_min": [9.0, 4.0, 1.5, 0.0]}
    metadata = trained.metadata.model_copy(update={"spotting": learned.model_copy(update=rates)})
    return replace(trained, metadata=metadata)
