"""How adaptation strength and neighbourhood radius fall while a map is trained."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Report = Callable[[int, int], None]
"""Called with the steps (or epochs) done and those in all."""

_SMALLEST_RADIUS = 1e-150
"""Smaller radii (grid units) cannot be squared in double precision."""
_LARGEST_RADIUS = 1e150
"""Nor can larger ones (grid units)."""


def silent(done: int, total: int) -> None:
    """Report nothing."""


@dataclass(frozen=True)
class Schedule:
    """How adaptation strength and neighbourhood radius (grid units) fall over the steps of a training.

    Both fall exponentially from the first value, reached at the first step, to the second, reached at the last.

    >>> alphas, radii = Schedule(alpha=(0.5, 0.02), radius=(4.0, 1.0)).values(3)
    >>> alphas.round(3).tolist(), radii.round(3).tolist()
    ([0.5, 0.1, 0.02], [4.0, 2.0, 1.0])

    Attributes:
        alpha: from 0 to 1, above 0.
        radius: in grid units, above 0.
    """

    alpha: tuple[float, float]
    radius: tuple[float, float]

    def values(self, steps: int) -> tuple[Array, Array]:
        """Return α and radius of each step, each of shape (steps,).

        Raises:
            ValueError: a value is not finite and above 0.
        """
        return falling(*self.alpha, steps), falling(*self.radius, steps)


@dataclass(frozen=True, eq=False)
class Steps:
    """Adaptation strength and neighbourhood radius of every single step, for any other decay.

    >>> alphas, radii = Steps(alphas=[0.5, 0.4], radii=[2, 1]).values(2)
    >>> alphas.tolist(), radii.tolist()
    ([0.5, 0.4], [2.0, 1.0])

    Attributes:
        alphas: (steps,), from 0 to 1.
        radii: (steps,), in grid units, above 0.
    """

    alphas: ArrayLike
    radii: ArrayLike

    def values(self, steps: int) -> tuple[Array, Array]:
        """Return α and radius of each step, each of shape (steps,).

        Raises:
            ValueError: there are not as many values as steps.
        """
        alphas, radii = np.array(self.alphas, np.float64), np.array(self.radii, np.float64)
        if alphas.shape != (steps,) or radii.shape != (steps,):
            raise ValueError(
                f"alphas have the shape {alphas.shape} and radii the shape {radii.shape}, but both need the shape "
                f"({steps},): give one value for each of the {steps} steps"
            )
        return alphas, radii


Decay = Schedule | Steps
"""What gives α and the radius of each step."""


def falling(first: float, last: float, steps: int) -> Array:
    """Return values (steps,) that fall exponentially from first to last.

    Raises:
        ValueError: first or last is not finite and above 0.
    """
    if not (0 < first < np.inf and 0 < last < np.inf):
        raise ValueError(
            f"an exponential schedule from {first} to {last} is not possible: give two finite values above 0"
        )
    return np.geomspace(first, last, steps)


def checked_radii(radii: ArrayLike) -> Array:
    """Return the radii, (n,) or a single one, as an array (n,).

    Raises:
        ValueError: one is not finite and above 0.
    """
    values = np.array(radii, np.float64, ndmin=1)
    if not ((values > _SMALLEST_RADIUS) & (values < _LARGEST_RADIUS)).all():
        raise ValueError(
            f"the neighbourhood radii are from {values.min()} to {values.max()}: give finite radii above 0"
        )
    return values
