"""Train a preset, answer what it has not seen, and count."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.training import train
from som_classifier.attention import ALL, MOVING, Axes, Origin, PostureInput
from som_classifier.presets import PAPER, PaperPreset, Preset

from .data import Data, Samples, Split

DRAWS = 10
SEEDS = 3
"""How many trainings where people, not chance, divide the samples."""


@dataclass(frozen=True)
class Shares:
    """The share of right answers of each draw or seed."""

    values: Sequence[float]

    def __str__(self) -> str:
        """Mean and standard deviation in percent."""
        return f"{100 * np.mean(self.values):.1f} ± {100 * np.std(self.values, ddof=1):.1f}"


@dataclass(frozen=True)
class Protocol:
    """What is learnt from and what is tested.

    Attributes:
        name: heads a column.
        runs: one split after the other of each draw or seed; the splits of one are counted together.
    """

    name: str
    runs: Callable[[Data], Iterable[Sequence[Split]]]

    def shares(self, data: Data, preset: Preset) -> Shares:
        """Train and test once for each draw or seed."""
        return Shares([_share(splits, preset, seed) for seed, splits in enumerate(self.runs(data))])


SET1 = Protocol("author's set, a random quarter", lambda data: [[data.quarter(draw)] for draw in range(DRAWS)])
LOOK_ALIKE = Protocol("five look-alikes", lambda data: [[data.look_alikes(draw)] for draw in range(DRAWS)])
MSR = Protocol("MSR, odd and even people", lambda data: [[data.odd_even()]] * SEEDS)
UTKINECT = Protocol("UTKinect, each person", lambda data: [data.other_people()] * SEEDS)
PROTOCOLS = (SET1, LOOK_ALIKE, MSR, UTKINECT)


def shown(
    attention: str = MOVING, axes: Axes = PAPER.posture.axes, origin: Origin = PAPER.posture.origin
) -> PaperPreset:
    """Return the preset with another input of the first map."""
    return replace(PAPER, posture=PostureInput(axes, origin, attention))


ARM, PART, BODY = shown("right_arm"), shown(MOVING), shown(ALL)


def labels(preset: Preset, training: Samples, test: Samples, seed: int) -> list[str]:
    """Return what a model of the training samples answers to each test sample."""
    model = train(training, preset, seed)
    return [answer(model, encoded(model, sample)).label for sample in test]


def _share(splits: Sequence[Split], preset: Preset, seed: int) -> float:
    right = [
        label == sample.label
        for training, test in splits
        for label, sample in zip(labels(preset, training, test, seed), test, strict=True)
    ]
    return float(np.mean(right))
