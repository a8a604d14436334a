"""Small models for tests in which it does not matter how often they are right."""

from dataclasses import replace

from actum.som import Schedule
from som_classifier.presets import PAPER, PYRAMID, BodyVariation, MapTraining

QUICK = replace(
    PYRAMID,
    name="quick",
    units=(8, 8),
    unit_epochs=5,
    unit_radius=(3.0, 0.6),
    others=BodyVariation(1, build_sd=0.1, tempo=1.0),
    stages=((0.3, 0.5), (0.7,), (1.0,)),
    concepts=(10, 10),
    concept_epochs=8,
    concept_radius=(4.0, 1.0),
)
QUICK_PAPER = replace(
    PAPER,
    name="quick paper",
    layer1=MapTraining(12, 12, 10_000, Schedule(PAPER.layer1.schedule.alpha, (6.0, 1.5))),
    layer2=MapTraining(12, 12, 5_000, Schedule(PAPER.layer2.schedule.alpha, (6.0, 0.5))),
)
