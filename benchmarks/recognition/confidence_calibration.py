"""Whether a confidence of 0.8 is right eight times in ten."""

from collections.abc import Iterator

import numpy as np

from actum_model_trainer.calibration_error import BINS, calibration_error, confidence_bins

from .bench import Bench
from .ours import OURS, PAPERS, Maps
from .scores import Floats, percent, table
from .splits import DRAWS, halves


def calibration(bench: Bench) -> Iterator[str]:
    """Confidence against accuracy."""
    answers = {maps.name: _answers(bench, maps) for maps in (OURS, PAPERS)}
    yield f"""Answers to whole sequences, pooled over the {DRAWS} draws of five and five people. ECE: mean distance
between accuracy and confidence over {BINS} bins of equal width. The ridge behind MiniRocket and MultiRocket and the
nearest neighbours give no probabilities, so they have no row; the paper's preset gives a share of cosines."""
    header = ("recogniser", "ECE", "mean confidence", "accuracy", "answers")
    yield table(header, (_summary(name, *own) for name, own in answers.items()))
    yield table((f"confidence, {OURS.name}", "answers", "mean confidence %", "right %"), _bins(*answers[OURS.name]))


def _answers(bench: Bench, maps: Maps) -> tuple[Floats, Floats]:
    """Return the confidences and whether each answer was right."""
    confidences, right = [], []
    for split in halves(bench.data.msr):
        recognitions = bench.fitted(maps, split.training).recognitions(split.test)
        confidences += [recognition.confidence for recognition in recognitions]
        right += [r.label == example.label for r, example in zip(recognitions, split.test, strict=True)]
    return np.array(confidences), np.array(right)


def _summary(name: str, confidences: Floats, right: Floats) -> list[str]:
    error = calibration_error(confidence_bins(confidences, right))
    return [name, f"{error:.3f}", f"{confidences.mean():.3f}", f"{right.mean():.3f}", str(len(right))]


def _bins(confidences: Floats, right: Floats) -> Iterator[list[str]]:
    for each in confidence_bins(confidences, right):
        yield [f"{each.low:.1f}–{each.high:.1f}", str(each.n), percent(each.confidence), percent(each.accuracy)]
