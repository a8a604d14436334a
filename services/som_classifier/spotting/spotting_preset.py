"""The part of a preset that the search for actions without marks depends on."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SpottingPreset:
    """What the search for actions without marks depends on.

    Attributes:
        interval_s: time between two decisions.
        lag_s: how long after its end an action is decided.
        overlap: the share of its duration by which an action may reach into the one before it.
        duration_weight: by how much completeness counts less per unit of log-likelihood of the duration.
        windows: how many durations of windows there are.
        shortest_quantile: of the training segments' durations, the shortest window; the longest is at one minus this.
        shrinkage: of the heads, in units of the mean squared length of the pooled vectors.
        most_windows: training windows; more make the heads hardly better, and their training costs n³.
        common_shares: of the head that all actions have in common; one is chosen by cross-validation.
        folds: of cross-validation, by people.
        thresholds: completeness at which recall and false alarms are counted, rising.
        false_alarm_threshold: completeness from which windows of background are false alarms to learn from.
    """

    interval_s: float
    lag_s: float
    overlap: float
    duration_weight: float
    windows: int
    shortest_quantile: float
    shrinkage: float
    most_windows: int
    common_shares: tuple[float, ...]
    folds: int
    thresholds: tuple[float, ...]
    false_alarm_threshold: float
