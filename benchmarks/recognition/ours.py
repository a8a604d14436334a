"""Our recogniser's presets, asked through the code that runs live."""

from collections.abc import Sequence
from dataclasses import dataclass

from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.training import train
from som_classifier.model import Model, Recognition
from som_classifier.presets import DEFAULT, PAPER, Preset

from .datasets import Example
from .splits import SEED


@dataclass(frozen=True)
class FittedMaps:
    """A trained model of ours."""

    model: Model

    def labels(self, examples: Sequence[Example], share: float = 1.0) -> list[str]:
        """Answer each sequence after a share of it; at 1 it is known to have ended."""
        return [recognition.label for recognition in self.recognitions(examples, share)]

    def recognitions(self, examples: Sequence[Example], share: float = 1.0) -> list[Recognition]:
        return [answer(self.model, encoded(self.model, example.sample), share) for example in examples]


@dataclass(frozen=True)
class Maps:
    """A preset to train."""

    preset: Preset

    @property
    def name(self) -> str:
        return f"actum, preset `{self.preset.name}`"

    def fit(self, examples: Sequence[Example]) -> FittedMaps:
        return FittedMaps(train([example.sample for example in examples], self.preset, SEED))


OURS = Maps(DEFAULT)
PAPERS = Maps(PAPER)
