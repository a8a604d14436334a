"""The choice of the search's settings: the best events F1 that keeps to the wanted rate of false alarms."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from actum_model_trainer.continuous.detections import Found
from actum_model_trainer.continuous.scoring import ActionScore
from actum_model_trainer.tuning.sensitivities import Sensitivity
from actum_model_trainer.tuning.weighing import Scores, Weighed, Wish, together, total
from som_classifier.spotting.spotted import SpottingOptions

PAUSES_S = (0.2, 0.5, 1.0)
"""Shortest pauses that are tried (s): from that between two strokes of one action to a breath between two actions."""
COOLDOWNS_S = (0.5, 1.0, 2.0, 3.0, 5.0)
"""Cooldowns that are tried for each action (s): up to where nobody understands why a repetition is not answered."""
FEWEST_SPARED = 2
"""False alarms that a setting has to spare beyond the right answers that it costs: a single one may be chance."""


@dataclass(frozen=True)
class Offer:
    """What one sensitivity gives, with the other settings that suit it best.

    Attributes:
        options: all of them.
        score: of all recordings together.
        false_per_min: false alarms in a minute of background; None without background.
    """

    options: SpottingOptions
    score: ActionScore
    false_per_min: float | None

    def keeps_to(self, most_per_min: float | None) -> bool:
        """Return whether it gives no more false alarms a minute; yes where none are named or can be counted."""
        return most_per_min is None or self.false_per_min is None or self.false_per_min <= most_per_min


@dataclass(frozen=True)
class Choice:
    """The offers, one for each sensitivity, and the best of them."""

    offers: tuple[Offer, ...]
    best: Offer


def chosen(weighed: Sequence[Weighed], most_per_min: float | None) -> Choice:
    """Choose the settings that give the best events F1 with at most so many false alarms a minute of background.

    Where no sensitivity has so few, that with the fewest is chosen; of equal ones the first, the model's own.
    """
    offers = tuple(_offer(weighed, sensitivity) for sensitivity in weighed[0].trial.searched)
    within = [offer for offer in offers if offer.keeps_to(most_per_min)]
    if within:
        return Choice(offers, max(within, key=lambda offer: offer.score.f1))
    return Choice(offers, min(offers, key=lambda offer: (offer.false_per_min or 0.0, -offer.score.f1)))


def found_in_all(weighed: Sequence[Weighed], options: SpottingOptions) -> Found:
    """Return what is found in all recordings with these options."""
    return sum((each.trial.found(options) for each in weighed), Found())


def held_out(weighed: Sequence[Weighed], most_per_min: float | None) -> Found:
    """Return what is found in each recording with settings chosen on all others; there are at least two recordings."""
    found = Found()
    for n, each in enumerate(weighed):
        found += each.trial.found(chosen([*weighed[:n], *weighed[n + 1 :]], most_per_min).best.options)
    return found


def _offer(weighed: Sequence[Weighed], sensitivity: Sensitivity) -> Offer:
    """Choose what suits a sensitivity best: which actions are switched off, each one's cooldown, and the pause."""
    bare = _scores(weighed, Wish(sensitivity))
    only_false = [label for label, own in bare.items() if not own.right and own.detections >= FEWEST_SPARED]
    wish = Wish(sensitivity, frozenset(only_false))
    pause_s, (cooldown_s, scores) = 0.0, _cooldowns(weighed, wish)
    for longer_s in PAUSES_S:
        trial = _cooldowns(weighed, replace(wish, shortest_pause_s=longer_s))
        if _is_worth_it(scores, trial[1]):
            pause_s, (cooldown_s, scores) = longer_s, trial
    score, minutes = total(scores.values()), sum(each.background_min for each in weighed)
    options = SpottingOptions(sensitivity, pause_s, cooldown_s, wish.disabled)
    return Offer(options, score, (score.detections - score.right) / minutes if minutes else None)


def _cooldowns(weighed: Sequence[Weighed], wish: Wish) -> tuple[dict[str, float], Scores]:
    """Return the cooldown (s) of each action that one is worth it for, and the scores with them."""
    scores, cooldown_s = _scores(weighed, wish), {}
    trials = [(longer_s, _scores(weighed, replace(wish, cooldown_s=longer_s))) for longer_s in COOLDOWNS_S]
    for label in list(scores):
        for longer_s, trial in trials:
            longer = scores | {label: trial[label]}
            if _is_worth_it(scores, longer):
                cooldown_s[label], scores = longer_s, longer
    return cooldown_s, scores


def _scores(weighed: Sequence[Weighed], wish: Wish) -> Scores:
    return together(each.scores(wish) for each in weighed)


def _is_worth_it(before: Scores, after: Scores) -> bool:
    """Return whether a setting that only withholds answers makes them better, by more than chance may."""
    less, more = total(after.values()), total(before.values())
    spared = (more.detections - more.right) - (less.detections - less.right)
    return less.f1 > more.f1 and spared - (more.right - less.right) >= FEWEST_SPARED
