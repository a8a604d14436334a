"""Linear discriminant axes by ridge regression, and the scores they give to people they were not trained on."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum_model_trainer.samples import SegmentSample

Floats = NDArray[Any]
Doubles = NDArray[np.float64]
Indices = NDArray[np.intp]

FOLDS_WITHOUT_PEOPLE = 5
MOST_FOLDS = 10
SMALLEST_LENGTH2 = 1e-9


@dataclass(frozen=True, eq=False)
class Axes:
    """What a training of the axes gives.

    Attributes:
        axes: (inputs, actions).
        offsets: (actions,).
        own: (n, actions), the scores of the training vectors.
        held_out: (n, actions), their scores on axes trained without their fold; `own` where no other has their action.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    own: Doubles
    held_out: Doubles


def folds_of(samples: Sequence[SegmentSample]) -> Indices:
    """Divide samples into folds: by person, or evenly those of an action that only one person did. Shape (n,).

    Were its only person left out, nothing could be learnt of the action.
    """
    people = sorted({sample.person for sample in samples})
    shared = {label for label, own in _people_by_label(samples).items() if len(own) > 1}
    counts: Counter[str] = Counter()
    folds = []
    for sample in samples:
        by_person = sample.label in shared
        folds.append(people.index(sample.person) % MOST_FOLDS if by_person else counts[sample.label])
        counts[sample.label] = (counts[sample.label] + 1) % FOLDS_WITHOUT_PEOPLE
    return np.array(folds)


def _people_by_label(samples: Sequence[SegmentSample]) -> dict[str, set[str]]:
    people: dict[str, set[str]] = {}
    for sample in samples:
        people.setdefault(sample.label, set()).add(sample.person)
    return people


def discriminant_axes(vectors: NDArray[np.float32], wanted: Doubles, folds: Indices, shrinkage: float) -> Axes:
    """Fit scores x · axes + offsets to what is wanted, minimising squared error + penalty × ‖axes‖².

    The penalty is `shrinkage` times the mean squared length of the centred vectors. Solved in the span of the
    vectors, whose inner products are all that is needed, once for all folds.

    Args:
        vectors: (n, inputs).
        wanted: (n, actions), 1 for the action done, else 0.
        folds: (n,), from `folds_of`.
        shrinkage: of the penalty.
    """
    mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
    centred = vectors - mean
    products = (centred @ centred.T).astype(np.float64)
    penalty = shrinkage * max(float(np.trace(products)) / len(products), SMALLEST_LENGTH2)
    inverse = np.linalg.inv(products + penalty * np.eye(len(products)))
    level: Doubles = wanted.mean(axis=0)
    solved = inverse @ (wanted - level)
    axes = centred.T @ solved.astype(np.float32)
    own = products @ solved + level
    held_out = own.copy()
    for fold in np.unique(folds):
        inside = np.flatnonzero(folds != fold)
        outside = np.flatnonzero(folds == fold)
        known = wanted[np.ix_(outside, np.flatnonzero(wanted[inside].any(axis=0)))].any(axis=1)
        if known.any():
            held_out[outside[known]] = _held_out(inverse, wanted, inside, outside)[known]
    return Axes(axes, (level - mean @ axes).astype(np.float32), own, held_out)


def _held_out(inverse: Doubles, wanted: Doubles, inside: Indices, outside: Indices) -> Doubles:
    """Return the scores of the rows outside on axes fitted to those inside, from the inverse B for all rows.

    By the inverse of a matrix in blocks, K_oi (K_ii + penalty)⁻¹ = −B_oo⁻¹ B_oi: nothing is fitted anew.
    """
    level: Doubles = wanted[inside].mean(axis=0)
    towards = inverse[np.ix_(outside, inside)] @ (wanted[inside] - level)
    scores: Doubles = level - np.linalg.solve(inverse[np.ix_(outside, outside)], towards)
    return scores
