"""The model of the simulated scene that comes with actum, and how it is trained."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from actum.recording import Recording
from actum_command.scene_marks import write_examples
from actum_model_trainer.progress import Progress
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train_to_spot
from scene_simulator.everyday import Pauses
from som_classifier.model import NOTHING_KEPT, Model
from som_classifier.presets import DEFAULT
from som_classifier.pyramid_model import PyramidModel

SIMULATED_MODEL = Path(__file__).with_name("simulated_model.npz")
"""The model's file, which `make simulated-model` writes."""
ACTOR = 0
"""The actor of the training, where it has one alone."""
TRAINING_SEED = 1
"""Which repetitions the training has; tests have others."""
TRAINERS = (ACTOR, *range(1001, 1009))
"""Actors of the training: numbers that no test of up to 900 people has."""
TRAINING_REPETITIONS = 2
"""Of each action by each of them: many people teach more than many repetitions, and half a minute is enough."""
PAUSES: Pauses = "short"
"""At most one everyday doing between two actions, in training and in the demo: a test of nine people then takes seven
minutes, not fifteen."""


def trained(progress: Progress) -> Model:
    """Train the model on a continuous recording of each person, about a minute and a half long.

    It keeps nothing of its training: it comes with actum, and would take several times the space.
    """
    with TemporaryDirectory(prefix="actum-simulated-") as folder:
        files = [Path(folder) / f"training-{actor}.mcap" for actor in TRAINERS]
        for actor, file in zip(TRAINERS, files, strict=True):
            write_examples(file, TRAINING_REPETITIONS, actor, TRAINING_SEED, "familiar", pauses=PAUSES)
        samples = samples_from(list(map(Recording, files)), progress)
    model = train_to_spot(samples.usable, samples.streams, DEFAULT, 0, progress)
    assert isinstance(model, PyramidModel)
    return replace(model, kept=NOTHING_KEPT)


def learned_from(model: Model) -> str:
    """Return what a model was trained on, in words."""
    return f"{model.metadata.samples} actions of {len(model.metadata.persons)} simulated people"
