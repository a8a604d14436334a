"""Which limb acts, and whether it is the left arm: left-handed actions are read as their mirror image."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Mask, has_unknown
from actum.core import steps
from actum.messages import Hand
from actum.skeletons import INDEX, JOINTS

Integers = NDArray[np.int64]

LIMBS = 4
"""Right arm, left arm, right leg, left leg."""
MOMENTS = 8
"""Sums kept of each limb: six coordinates, their squared length, and a count."""
_LIMBS = np.array(
    [
        [INDEX[f"{side}_{middle}"], INDEX[f"{side}_{end}"]]
        for side, middle, end in (
            ("right", "elbow", "hand"),
            ("left", "elbow", "hand"),
            ("right", "knee", "foot"),
            ("left", "knee", "foot"),
        )
    ]
)
COMPONENTS = (3 * _LIMBS[..., None] + np.arange(3)).reshape(LIMBS, -1)
"""The coordinates of each limb among the 45 of a posture, (4, 6)."""
_RIGHT_ARM = 0
_LEFT_ARM = 1
_UNITS_PER_M = 1000
"""Whole millimetres: finer than any tracker, and sums over the longest segment stay far below 2⁶³."""
_JITTER_MM = 20.0
"""Added to the spreads of both arms before they are compared, so that noise makes no resting arm the acting one."""
_FACTOR = 1.65
"""How many times the other arm's spread the acting arm's must be; below, both act."""
ARMS = (_JITTER_MM, _FACTOR)
"""By what the compiled steps tell which arm acts."""

OPPOSITE = np.array([INDEX[name.replace("left_", "R_").replace("right_", "left_").replace("R_", "right_")]
                     for name in JOINTS])  # fmt: skip
"""(15,), for each joint the one on the other side of the body."""
ACROSS = np.array([-1.0, 1.0, 1.0])
"""(3,), the signs by which mirroring multiplies the axes left, up, forward."""


def mirrored(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions or velocities (…, 15, 3) of the actor's mirror image, same shape."""
    image: NDArray[np.float64] = vectors[..., OPPOSITE, :] * ACROSS
    return image


def limb_moments(posture: NDArray[np.float64]) -> Integers:
    """Return the first and second moments of each limb, of which its spread over a segment is computed, (…, 4, 8).

    They are the six coordinates of its two joints in whole millimetres, the sum of their squares, and 1; all 0 where a
    joint is missing. Being integers they add up to the same sums in any order.

    Args:
        posture: (…, 15, 3), metres, NaN where a joint is missing.
    """
    result = np.empty((*posture.shape[:-2], LIMBS, MOMENTS))
    limbs = result[..., :6]
    np.rint(posture.reshape(*posture.shape[:-2], -1)[..., COMPONENTS] * _UNITS_PER_M, out=limbs)
    np.einsum("...ij,...ij->...i", limbs, limbs, out=result[..., 6])
    result[..., 7] = 1.0
    if has_unknown(result[..., 6]):
        result[np.isnan(result[..., 6])] = 0.0
    return result.astype(np.int64)


class LimbSpreads(NamedTuple):
    """How much each limb moves over a segment.

    Attributes:
        limbs: (4,), the standard deviation of each limb's joints about their mean position, mm.
    """

    limbs: Sequence[float]

    @classmethod
    def of(cls, summed: Integers) -> "LimbSpreads":
        """Compute the spreads from the moments (4, 8) summed over the frames."""
        return cls([_spread(limb) for limb in summed.tolist()])

    @classmethod
    def between(cls, before: Integers, after: Integers) -> "LimbSpreads":
        """Compute the spreads of some frames from the moments (4, 8) summed over all before them, and with them."""
        return cls.of(after - before) if steps is None else cls(steps.spreads(before, after))

    @property
    def acting_hand(self) -> Hand | None:
        """The side of the arm that moves most of all limbs, and clearly more than the other arm; else None."""
        sides: tuple[tuple[Hand, int, int], ...] = (("left", _LEFT_ARM, _RIGHT_ARM), ("right", _RIGHT_ARM, _LEFT_ARM))
        most = max(self.limbs)
        for hand, arm, other in sides:
            if most == self.limbs[arm] and most + _JITTER_MM > _FACTOR * (self.limbs[other] + _JITTER_MM):
                return hand
        return None

    @property
    def left_handed(self) -> bool:
        """Whether the left arm acts."""
        return self.acting_hand == "left"


def left_arm_acts(before: Integers, after: Integers, first: int) -> bool:
    """Tell whether the left arm acts in some frames.

    Args:
        before: sums over all frames before them, of which those from the `first` on are moments of the limbs (4 * 8).
        after: the same with them.
        first: an index.
    """
    if steps is not None:
        acts: bool = steps.left_arm_acts(before, after, first, *ARMS)
        return acts
    moments = (after - before)[first : first + LIMBS * MOMENTS]
    return LimbSpreads.of(moments.reshape(LIMBS, MOMENTS)).left_handed


def left_handed(before: Integers, after: Integers) -> Mask:
    """Return whether the left arm acts in each of n spans of frames, as `LimbSpreads.left_handed` says, (n,).

    Args:
        before: (n, 4, 8), the moments summed over all frames before each span.
        after: the same with those of the span.
    """
    return _acts(_spreads(before, after), _LEFT_ARM, _RIGHT_ARM)


def acting_hands(before: Integers, after: Integers) -> list[Hand | None]:
    """Return the side of the arm that acts in each of n spans, as `LimbSpreads.acting_hand` says; see `left_handed`."""
    limbs = _spreads(before, after)
    arms = _acts(limbs, _LEFT_ARM, _RIGHT_ARM).tolist(), _acts(limbs, _RIGHT_ARM, _LEFT_ARM).tolist()
    return ["left" if left else "right" if right else None for left, right in zip(*arms, strict=True)]


def _spreads(before: Integers, after: Integers) -> Floats:
    """Return each limb's spread in each of n spans, mm, (n, 4)."""
    moments = (after - before).astype(np.float64)
    counts = np.maximum(moments[..., 7], 1.0)
    means2 = np.square(moments[..., :6]).sum(axis=-1) / counts**2
    spreads: Floats = np.sqrt(np.maximum(moments[..., 6] / counts - means2, 0.0))
    return spreads


def _acts(limbs: Floats, arm: int, other: int) -> Mask:
    """Return where an arm moves most of all limbs (n, 4), and clearly more than the other arm, (n,)."""
    own = limbs[:, arm]
    acts: Mask = (own == limbs.max(axis=1)) & (own + _JITTER_MM > _FACTOR * (limbs[:, other] + _JITTER_MM))
    return acts


def _spread(limb: Sequence[int]) -> float:
    """Return √(mean |x|² − |mean x|²), mm, from the sums of x (6 coordinates), of |x|² and of 1."""
    a, b, c, d, e, f, squares, count = limb
    if not count:
        return 0.0
    return math.sqrt(max(squares / count - (a * a + b * b + c * c + d * d + e * e + f * f) / count**2, 0.0))
