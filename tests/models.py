"""Small models for tests in which it does not matter how often they are right."""

from dataclasses import replace

from som_classifier.presets import PYRAMID, Others

QUICK = replace(
    PYRAMID,
    name="quick",
    units=(8, 8),
    unit_epochs=5,
    unit_radius=(3.0, 0.6),
    others=Others(1, build_sd=0.1, tempo=1.0),
    stages=((0.3, 0.5), (0.7,), (1.0,)),
    concepts=(10, 10),
    concept_epochs=8,
    concept_radius=(4.0, 1.0),
)
