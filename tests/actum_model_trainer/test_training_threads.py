"""One BLAS thread or two: the same models and the same answers to the bit."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
from dataclasses import replace
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.training import train
from performers import TINY_PAPER
from recognisers import tiny_samples
from som_classifier.presets import PYRAMID
from unmarked import spotting_model
print("search", spotting_model().id)
full_size = replace(PYRAMID, unit_epochs=2, concept_epochs=2)
for preset in (full_size, TINY_PAPER):
    model = train(tiny_samples(), preset)
    print(preset.name, model.id)
    for sample in tiny_samples():
        frames = encoded(model, sample)
        for fraction in (0.3, 0.6, 1.0):
            found = answer(model, frames, fraction)
            print(found.label, found.confidence.hex(), [cosine.hex() for cosine in found.activations.values()])
"""


def output(threads: int) -> list[str]:
    path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": str(threads), "PYTHONPATH": path}
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


@pytest.mark.long
def test_one_and_two_threads_give_the_same_models_and_answers() -> None:
    with_one = output(1)
    assert len(with_one) == 1 + 2 * (1 + 6 * 3)
    assert with_one == output(2)
