"""What each step of the paper is worth: left out, as printed, or otherwise."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from benchmarks.recognition.scores import table

from actum.som import Schedule
from som_classifier.presets import PAPER, MapTraining, PaperPreset

from .data import Data
from .measuring import BODY, MSR, PART, SET1, UTKINECT, shown

NO_CONTRAST = 1e9
"""exp(−d² / σ) with a σ as far above the distances as the paper's 10⁶ is above metres."""
WINNER_ALONE = 1e-9


def _layer1(**changes: Any) -> PaperPreset:
    return replace(PAPER, layer1=replace(PAPER.layer1, **changes))


def _radius(last: float) -> Schedule:
    return Schedule(PAPER.layer1.schedule.alpha, (PAPER.layer1.schedule.radius[0], last))


STEPS: dict[str, PaperPreset] = {
    "the preset": PART,
    "axes of every posture anew, as printed": shown(axes="posture"),
    "from the middle of the hips instead of the torso": shown(origin="hips"),
    "no attention: the whole body": BODY,
    "a fixed part: the right arm": shown("right_arm"),
    "the winner's place instead of the centre of activity": replace(PAPER, centre_contrast=WINNER_ALONE),
    "a third of the first map's contrast": replace(PAPER, centre_contrast=PAPER.centre_contrast / 3),
    "three times that contrast": replace(PAPER, centre_contrast=PAPER.centre_contrast * 3),
    "first map down to a radius of 1": _layer1(schedule=_radius(1.0)),
    "down to 6": _layer1(schedule=_radius(6.0)),
    "a first map of 15 × 15": _layer1(
        rows=15, cols=15, schedule=Schedule(PAPER.layer1.schedule.alpha, (7.5, PAPER.layer1.schedule.radius[1] / 2))
    ),
    "a tenth of its steps": _layer1(steps=PAPER.layer1.steps // 10),
    "the second map's activity as printed": replace(PAPER, relative_contrast=NO_CONTRAST),
    "three times its contrast": replace(PAPER, relative_contrast=PAPER.relative_contrast * 3),
    "a second map of 12 × 12": replace(
        PAPER, layer2=MapTraining(12, 12, PAPER.layer2.steps, Schedule(PAPER.layer2.schedule.alpha, (6.0, 0.5)))
    ),
    "the delta rule's sign as printed": replace(PAPER, beta=-PAPER.beta),
}


def steps(data: Data) -> Iterator[str]:
    """Each step replaced, all else as it is."""
    yield """One thing changed at a time, all else as in the preset, which attends to the part that moves most. Right
answers in %, mean ± standard deviation over the draws or seeds of the table above."""
    columns = (SET1, MSR, UTKINECT)
    yield table(
        ("changed", *(protocol.name for protocol in columns)),
        ([name, *(str(protocol.shares(data, preset)) for protocol in columns)] for name, preset in STEPS.items()),
    )
