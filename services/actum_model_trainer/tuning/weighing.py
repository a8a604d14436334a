"""What settings are worth on a recording: for each action, how often it was done, found, and found rightly."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from actum_model_trainer.continuous.matching import intersection_over_union, matched
from actum_model_trainer.continuous.scoring import ActionScore, background_min
from actum_model_trainer.tuning.sensitivities import Sensitivity
from actum_model_trainer.tuning.trials import Trial
from som_classifier.spotting.spotted import SpottingOptions

Scores = dict[str, ActionScore]
"""By action."""


@dataclass(frozen=True)
class Wish:
    """Settings with the same cooldown for every action: no action's cooldown changes the answers to another."""

    sensitivity: Sensitivity
    disabled: frozenset[str] = frozenset()
    shortest_pause_s: float = 0.0
    cooldown_s: float = 0.0


@dataclass(frozen=True, eq=False)
class Weighed:
    """A recording on which many settings are weighed, each of them once."""

    trial: Trial
    known: dict[Wish, Scores] = field(default_factory=dict)

    @property
    def background_min(self) -> float:
        """For how many minutes people did none of the actions."""
        return background_min(self.trial.marked.seen, self.trial.marked.truths)

    def scores(self, wish: Wish) -> Scores:
        """Return the scores of all actions that were done, or found with this sensitivity."""
        if wish not in self.known:
            searched = {each.label for stretch in self.trial.searched[wish.sensitivity] for each in stretch}
            cooldown_s = dict.fromkeys(searched, wish.cooldown_s)
            options = SpottingOptions(wish.sensitivity, wish.shortest_pause_s, cooldown_s, wish.disabled)
            found = self.trial.found(options)
            done = Counter(truth.label for truth in found.truths)
            answered = Counter(each.label for each in found.detections)
            matches = matched(found.detections, found.truths, intersection_over_union)
            right = Counter(match.truth.label for match in matches)
            self.known[wish] = {
                label: ActionScore(done[label], answered[label], right[label]) for label in searched | done.keys()
            }
        return self.known[wish]


def together(scores: Iterable[Scores]) -> Scores:
    """Add the scores of several recordings."""
    totals: dict[str, list[ActionScore]] = {}
    for each in scores:
        for label, own in each.items():
            totals.setdefault(label, []).append(own)
    return {label: total(parts) for label, parts in sorted(totals.items())}


def total(scores: Iterable[ActionScore]) -> ActionScore:
    """Add scores."""
    parts = [(own.truths, own.detections, own.right) for own in scores]
    truths, detections, right = (sum(counts) for counts in zip(*parts, strict=True)) if parts else (0, 0, 0)
    return ActionScore(truths, detections, right)
