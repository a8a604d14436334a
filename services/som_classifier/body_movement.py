"""How much people move in an action: where legs or trunk move far more, or nothing moves, another movement is done."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Mask
from actum.core import steps
from actum.skeletons import INDEX
from som_classifier.kinematics import AVERAGED_NS, averaged, movement_m
from som_classifier.model import Recognition

PARTS = (
    tuple(INDEX[joint] for joint in ("left_knee", "left_foot", "right_knee", "right_foot")),
    tuple(INDEX[joint] for joint in ("neck", "head")),
)
"""The joints of the legs, and those of the trunk."""
_COMPILED_PARTS = tuple(np.array(part, np.int32) for part in PARTS)
LEAST_M = 0.03
"""Legs or a trunk that move less are at rest: joints of people who stand still move by as much (m)."""


def movements(stamps_ns: NDArray[np.int64], postures: Array) -> tuple[Array, float]:
    """Return how much the parts move in a segment, as `log_movements`, and how far the person does, as `movement_m`.

    Args:
        stamps_ns: (n,), rising.
        postures: (n, 15, 3), contiguous, as those of `averaged`.
    """
    moved = None if steps is None else steps.movements(stamps_ns, postures, AVERAGED_NS, *_COMPILED_PARTS)
    if moved is not None:
        *of_parts, moved_m = moved
        return np.log([max(of_part, LEAST_M) for of_part in of_parts]), moved_m
    means = averaged(stamps_ns, postures)
    return log_movements(means), movement_m(means)


def log_movements(means: Array) -> Array:
    """Return the logarithm of how much each part moves in a segment, (2,), NaN where none of its joints is seen.

    A part's movement is the standard deviation of its joints' positions in the upright frame (m).

    Args:
        means: (intervals, 15, 3), as `averaged` returns them.
    """
    seen: Mask = np.asarray(~np.isnan(means[:, :, 0]).all(axis=0))
    known = np.where(seen[:, None], means, 0.0)
    variances_m2 = np.nanvar(known, axis=0) if np.isnan(known).any() else known.var(axis=0)
    deviations_m = np.sqrt(variances_m2.sum(axis=1))
    of_parts = [deviations_m[[joint for joint in part if seen[joint]]] for part in PARTS]
    return np.log([max(float(each.mean()), LEAST_M) if len(each) else np.nan for each in of_parts])


class Evidence(NamedTuple):
    """What complete segments are judged by.

    Attributes:
        pooled: (inputs,), the pyramid's vector.
        features: (features,), of the convolutions.
        moved: (2,), how much legs and trunk move, as `log_movements` returns it.
        moved_m: how far the person moves.
    """

    pooled: NDArray[np.float32]
    features: NDArray[np.float32]
    moved: Array
    moved_m: float


@dataclass(frozen=True)
class BodyMovement:
    """How much people move in each action.

    Attributes:
        usual: (actions, 2), mean logarithm of how much legs and trunk move (m).
        most_above: (2,), how far that of a segment may lie above the usual; a true instance's hardly ever lies higher.
        least_m: everybody who acts moves at least so far.
    """

    usual: Sequence[Sequence[float]]
    most_above: Sequence[float]
    least_m: float

    def doubted(self, recognition: Recognition, action: int, evidence: Evidence) -> Recognition:
        """Return the answer as it is or, where the person moves otherwise than in the action (its index), as doubtful.

        A segment that moves less than any action is unknown, and as much less sure. Scores alone do not show that:
        every action begins and ends at rest, so that rest scores like a part of one. Nor do they show legs or a trunk
        that move far more: these lower the familiarity. What is not seen raises no doubt.
        """
        still = 1.0 if evidence.moved_m >= self.least_m else evidence.moved_m / self.least_m
        of_parts = zip(evidence.moved.tolist(), self.usual[action], self.most_above, strict=True)
        excesses = [moved - usual - most for moved, usual, most in of_parts]
        above = max(0.0 if math.isnan(excess) else excess for excess in excesses)
        if still == 1.0 and above <= 0.0:
            return recognition
        return replace(
            recognition,
            confidence=still * recognition.confidence,
            familiarity=still * math.exp(-max(above, 0.0)) * (recognition.familiarity or 0.0),
            unknown=recognition.unknown or still < 1.0,
            doubtful=True,
        )
