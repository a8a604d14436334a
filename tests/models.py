"""Small models for tests in which it does not matter how often they are right."""

from dataclasses import replace

from som_classifier.presets import PAPER

QUICK = replace(
    PAPER,
    name="quick",
    layer1=replace(PAPER.layer1, rows=12, cols=12, steps=8_000),
    layer2=replace(PAPER.layer2, rows=12, cols=12, steps=2_000),
    epochs=5,
)
