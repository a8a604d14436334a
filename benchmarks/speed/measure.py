"""Measures what a user waits for in the tree that PYTHONPATH names, and prints it as JSON, larger being faster.

The scene, the model and all else come from that tree: only what several versions have in common is called.
"""

import json
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from benchmarks.latency.scene import stream
from benchmarks.throughput import frames_per_second

from actum.messages import Segment
from actum.recording import Recording
from actum_command.scene_marks import write_examples
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import Samples
from actum_model_trainer.training import train, train_to_spot
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.presets import DEFAULT

TIMES = 3
"""How often rates of frames are measured: the fastest counts, as whatever else the machine does only slows it down."""


def main() -> None:
    """Measure all."""
    with tempfile.TemporaryDirectory() as folder:
        examples = Path(folder) / "examples.mcap"
        write_examples(examples, repetitions=12, actor=0, seed=1)
        samples = samples_from([Recording(examples)])
    rates: Mapping[str, Callable[[], float]] = {
        "preprocessor + classifier, partial answers in all frames, frames/s": partial(
            frames, without_search(samples), marks=True
        ),
        "preprocessor + classifier, searching, frames/s": partial(frames, trained(samples), marks=False),
    }
    fastest = {name: max(rate() for _ in range(TIMES)) for name, rate in rates.items()}
    print(json.dumps(fastest | {"trainings with the search, per minute": trainings(samples)}))


def trained(samples: Samples) -> Model:
    """Train a model that also searches."""
    return train_to_spot(samples.usable, samples.streams, DEFAULT)


def without_search(samples: Samples) -> Model:
    """Train a model that answers marked segments alone."""
    return train(samples.usable, DEFAULT)


def frames(model: Model, marks: bool) -> float:
    """Return the frames per second on one core, with or without marks that ask for partial answers."""
    messages = [message for message in stream() if marks or not isinstance(message, Segment)]
    return frames_per_second(messages, PosePreprocessor(PoseSettings.defaults()), SomClassifier(model))


def trainings(samples: Samples) -> float:
    """Return how many models could be trained in a minute on one core."""
    began_s = time.process_time()
    trained(samples)
    return 60 / (time.process_time() - began_s)


if __name__ == "__main__":
    main()
