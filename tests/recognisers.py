"""A small trained model for tests that need a classifier and not a good one."""

import tempfile
from functools import cache
from pathlib import Path

from actum.recording import Recorder, Recording
from model_trainer.samples import samples_from
from model_trainer.training import train
from performers import HAND_PATHS, TINY, performance
from som_classifier.model import Model


@cache
def tiny_model() -> Model:
    """Train on one synthetic person who does every action twice."""
    skeletons, marks = performance([*HAND_PATHS] * 2)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "performance.mcap"
        with Recorder(path, person="1", source="test") as recorder:
            for message in [*skeletons, *marks]:
                recorder.write(message)
        return train(samples_from([Recording(path)]).usable, TINY)
