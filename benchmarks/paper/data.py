"""What the paper's recogniser is measured on: three sets of recordings, and the simulated scene."""

from functools import cached_property
from pathlib import Path

import numpy as np
from benchmarks.originals import ImportedSets
from benchmarks.recognition import splits
from benchmarks.recognition.datasets import Datasets
from benchmarks.recognition.splits import TEST_SHARE, leave_one_person_out, odd_even
from numpy.typing import NDArray

from actum.recording import Recording
from actum_command.scene_marks import write_examples
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample

from .set1 import import_set1

LOOK_ALIKES = ("high arm wave", "hammer", "forward punch", "high throw", "draw x")
"""Five actions of the author's set in which one arm goes up and ahead, as in those of the paper."""
TRAINED_EACH, TESTED_EACH = 12, 9
"""As the paper has of each action."""
TRAINING_SEED, TEST_SEED = 1, 2

Samples = list[SegmentSample]
Split = tuple[Samples, Samples]
"""What to learn from, and what to answer."""


class Data:
    """The sets below one folder, imported into another when first asked for."""

    def __init__(self, imported: Path) -> None:
        self._public, self._imported = Datasets(imported), imported

    @cached_property
    def set1(self) -> Samples:
        """The 276 sequences of the paper's first author."""
        return samples_from(ImportedSets(self._imported).recordings("gharaee_set1", import_set1)).usable

    @cached_property
    def msr(self) -> Samples:
        """The 557 sequences of MSR Action3D."""
        return [example.sample for example in self._public.msr]

    @cached_property
    def msr_in_camera_m(self) -> list[NDArray[np.float64]]:
        """Their joints in camera axes, (n, 15, 3) each."""
        return [example.camera_m for example in self._public.msr]

    @cached_property
    def utkinect(self) -> Samples:
        """The labelled segments of UTKinect."""
        return [example.sample for example in self._public.utkinect]

    def quarter(self, draw: int) -> Split:
        """Test a random quarter of the author's set, whoever did it."""
        order, count = np.random.default_rng(draw).permutation(len(self.set1)), round(TEST_SHARE * len(self.set1))
        return [self.set1[i] for i in order[count:]], [self.set1[i] for i in order[:count]]

    def look_alikes(self, draw: int) -> Split:
        """Draw as many of each look-alike action as the paper has."""
        rng, training, test = np.random.default_rng(draw), [], []
        for label in LOOK_ALIKES:
            own = [sample for sample in self.set1 if sample.label == label]
            shuffled = [own[i] for i in rng.permutation(len(own))]
            training += shuffled[:TRAINED_EACH]
            test += shuffled[TRAINED_EACH : TRAINED_EACH + TESTED_EACH]
        return training, test

    def odd_even(self) -> Split:
        """Learn from people 1, 3, 5, 7 and 9 of MSR Action3D, test the others."""
        return _samples_of(odd_even(self._public.msr))

    def other_people(self) -> list[Split]:
        """Test each person of UTKinect on what the others did."""
        return [_samples_of(split) for split in leave_one_person_out(self._public.utkinect)]

    def simulated(self, actor: int, repetitions: int, seed: int) -> Samples:
        """Let an actor of the simulated scene do the paper's five actions."""
        path = self._imported / f"simulated-{actor}-{repetitions}-{seed}.mcap"
        if not path.exists():
            write_examples(path, repetitions, actor, seed)
        return samples_from([Recording(path)]).usable

    def one_actor(self, actor: int) -> Split:
        """Learn from and test one simulated actor, as the paper does."""
        return (
            self.simulated(actor, TRAINED_EACH, TRAINING_SEED),
            self.simulated(actor, TESTED_EACH, TEST_SEED),
        )


def _samples_of(split: splits.Split) -> Split:
    return [example.sample for example in split.training], [example.sample for example in split.test]
