"""The different sensitivities of a model's search, each named by a rate of false alarms that one can ask for."""

import math

from actum_model_trainer.continuous.watching import NoSpotterError
from som_classifier.model import Model

Sensitivity = float | None
"""False alarms a minute that are asked for; None for what the model was trained for."""
MOST_DECIMALS = 6  # of a rate that is asked for; two thresholds whose rates differ by less are the same to anybody


def sensitivities(model: Model) -> list[Sensitivity]:
    """List one sensitivity for each threshold that can be asked for: first the model's own, then from many to few.

    It is the only one where the model was trained without background, so that it knows no rates.

    Raises:
        NoSpotterError: the model cannot find actions without marks.
    """
    learned = model.spotting
    if learned is None:
        raise NoSpotterError(model)
    rates = learned.false_alarms_per_min
    found: list[Sensitivity] = [None]
    for rate, above in zip(rates, [math.inf, *rates], strict=False):
        if rate < above:
            asked = plainest(rate, above)
            if learned.threshold_for(asked) != learned.threshold:
                found.append(asked)
    return found


def plainest(least: float, below: float) -> float:
    """Return the number with the fewest decimals that is positive, at least `least`, and less than `below`."""
    for decimals in range(MOST_DECIMALS):
        unit = 10.0**-decimals
        rounded = round(max(math.ceil(least / unit), 1) * unit, decimals)
        if least <= rounded < below:
            return rounded
    return least or below / 2
