"""What is counted, and how it is written."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.evaluation import wilson_interval

from .datasets import Example

Floats = NDArray[Any]


@dataclass(frozen=True)
class Score:
    """How many of how many."""

    correct: int
    n: int

    @classmethod
    def of(cls, answers: Sequence[str], examples: Sequence[Example]) -> "Score":
        right = sum(answer == example.label for answer, example in zip(answers, examples, strict=True))
        return cls(right, len(examples))

    def __add__(self, other: "Score") -> "Score":
        return Score(self.correct + other.correct, self.n + other.n)

    @property
    def share(self) -> float:
        return self.correct / self.n

    @property
    def cells(self) -> list[str]:
        """Write share, count and Wilson's 95 % interval."""
        low, high = wilson_interval(self.correct, self.n)
        return [percent(self.share), f"{self.correct}/{self.n}", f"{percent(low)}–{percent(high)}"]


@dataclass(frozen=True)
class Difference:
    """What lies between two series of the same draws."""

    values: Floats

    @property
    def mean(self) -> float:
        return float(self.values.mean())

    @property
    def standard_error(self) -> float:
        """As if the draws were independent."""
        return float(self.values.std(ddof=1) / np.sqrt(len(self.values)))

    def corrected_error(self, test_to_training: float) -> float:
        """Return the standard error with Nadeau and Bengio's (2003) correction for draws that overlap."""
        return float(self.values.std(ddof=1) * np.sqrt(1 / len(self.values) + test_to_training))


def percent(share: float) -> str:
    return f"{100 * share:.1f}"


def mean_sd(values: Sequence[float]) -> list[str]:
    return [percent(float(np.mean(values))), percent(float(np.std(values, ddof=1)))]


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a Markdown table, the first column to the left and the others to the right."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
