"""The scores of what actum foresees in recordings, beside what is simpler."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from action_fusion.intent.contact_network import shipped_network
from actum_model_trainer.foreseeing.baselines import compared
from actum_model_trainer.foreseeing.recorded import Recorded
from actum_model_trainer.foreseeing.said import said_by
from actum_model_trainer.foreseeing.scoring import (
    BEFORE_S,
    Scores,
    calibration_error,
    false_alarms_per_min,
)
from actum_model_trainer.progress import Progress, silent


@dataclass(frozen=True)
class IntentScores:
    """How well contacts are foreseen.

    Attributes:
        contacts: their number.
        minutes: how long the people were seen, in sum.
        without_contact: number of marked actions in which no contact was found.
        methods: the scores of actum and of each baseline by name.
        calibration_error: expected calibration error of actum's probabilities.
        false_alarms_per_min: how often a minute actum announces a contact that does not come.
    """

    contacts: int
    minutes: float
    without_contact: int
    methods: Mapping[str, Scores]
    calibration_error: float
    false_alarms_per_min: float

    def as_json(self) -> dict[str, Any]:
        """Return the scores as plain values for JSON."""
        return {
            "contacts": self.contacts,
            "minutes": self.minutes,
            "without_contact": self.without_contact,
            "calibration_error": self.calibration_error,
            "false_alarms_per_min": self.false_alarms_per_min,
            "methods": {name: _as_json(scores) for name, scores in self.methods.items()},
        }


def _as_json(scores: Scores) -> dict[str, Any]:
    ahead, half = scores.ahead, scores.at_half
    return {
        "ahead_s": ahead.median_s,
        "precision": ahead.precision,
        "announced_ahead": ahead.recall,
        "right": {str(seconds): _number(each.right) for seconds, each in zip(BEFORE_S, scores.before, strict=True)},
        "brier": half.brier if scores.is_probable else None,
        "time_error_s": half.time_error_s if scores.is_probable else None,
    }


def _number(value: float) -> float | None:
    return None if np.isnan(value) else value


def intent_scores(recorded: Recorded, progress: Progress = silent) -> IntentScores:
    """Let the network that comes with actum foresee the contacts in takes, of which there is one at least."""
    said = []
    for done, take in enumerate(recorded.takes):
        progress("foreseeing contacts", done, len(recorded.takes))
        said.append(said_by(shipped_network(), take))
    progress("foreseeing contacts", len(said), len(said))
    return IntentScores(
        contacts=recorded.contacts,
        minutes=sum(take.minutes for take in recorded.takes),
        without_contact=recorded.without_contact,
        methods=compared(said),
        calibration_error=calibration_error(said),
        false_alarms_per_min=false_alarms_per_min(said),
    )
