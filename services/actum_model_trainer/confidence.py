"""How sure a new model's answers may be, and from when on an action counts as unknown.

Both follow from people held out of training. Of few people that says little, of one alone nothing, so what was usual
for models of other people's actions counts as well, as though it had been seen in `Prior.people` more people.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.calibration import matched_gain
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.upper_layers import Scored, UpperLayers
from som_classifier.first_layer import FirstMaps
from som_classifier.presets import Prior, PyramidPreset

Floats = NDArray[Any]
Indices = NDArray[np.intp]


def calibrated_gains(
    stages: Sequence[Scored], upper: UpperLayers, prior: Prior, people: int, depth_inferred: bool
) -> list[float]:
    """Return what makes cosines logits at each stage: between the usual gain and the matched one, at most that.

    People held out of training differ less from the others than strangers do, so the matched gain is rather too large.

    Args:
        people: how many were learnt from; the first of them says nothing of how people differ.
        depth_inferred: whether some distances follow from a picture and a body's usual size, which are less exact.
    """
    usual = prior.gain_where_inferred if depth_inferred else prior.gain
    matched = np.array([held_out_gain(stage, upper) for stage in stages])
    drawn = np.exp(_drawn(np.log(usual), np.log(matched), prior, people))
    return [float(gain) for gain in np.minimum(matched, drawn)]


def held_out_gain(stage: Scored, upper: UpperLayers) -> float:
    """Return the gain that makes the answers to held-out scores as sure as the largest of these scores is right.

    Whether the cosines are right would say less: the upper layers have learnt these very scores. That all n are right
    does not make the next one sure: as after Laplace, one right and one wrong answer are added.
    """
    right = int((stage.axes.held_out.argmax(axis=1) == stage.targets).sum())
    return matched_gain(upper.cosines(stage.axes.held_out), (right + 1) / (len(stage.targets) + 2))


def familiar(held_out: Floats, samples: Sequence[SegmentSample], preset: PyramidPreset) -> float:
    """Return the familiarity that most segments of known actions exceed.

    Args:
        held_out: (n, actions), scores on axes that were trained without the person.
        samples: what was learnt from.
    """
    prior, people = preset.prior, len({sample.person for sample in samples})
    once = len({(sample.person, sample.label) for sample in samples}) == len(samples)
    exceeded = np.quantile(held_out.max(axis=1), 1 - preset.known_share)
    return float(_drawn(prior.familiar_from_one if once else prior.familiar, exceeded, prior, people))


def usual_log_errors(first: FirstMaps, postures: Sequence[Floats], targets: Indices, prior: Prior) -> list[float]:
    """Return to what mean log(d²) from the map of postures a stranger who does each action may well come.

    It is the usual one, higher or lower by as much as the action's own samples are off the map more or less than all
    are: a map has few units for postures that are seldom taken. As there may be few, their mean counts as one of each.

    Args:
        postures: (frames, 15, 3) of each sample, as the classifier reads it.
        targets: (n,), their actions.
    """
    log_errors = np.array([first.log_errors(own, first.winners(own)).mean() for own in postures])
    above = np.bincount(targets, weights=log_errors - log_errors.mean()) / (np.bincount(targets) + 1)
    return [float(prior.log_error + own) for own in above]


def _drawn(usual: Any, seen: Any, prior: Prior, people: int) -> Any:
    return (prior.people * usual + (people - 1) * seen) / (prior.people + people - 1)
