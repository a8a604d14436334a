"""The ordered vector: the trajectory of activity over the first map, independent of pace (paper, section 2.1)."""

import numpy as np

from actum.arrays import Array, Indices, Mask
from som_classifier.map_activity import NO_WINNER, MapActivity


def trajectory(frames: MapActivity) -> Array:
    """Return the centres of activity at each change of the winner, shape (changes, 2), row and column in grid units.

    Frames without a winner are left out.

    Args:
        frames: winners (n,) and centres (n, 2), of one input per frame.
    """
    known = frames[frames.winners != NO_WINNER]
    return known.centres[changes(known.winners)]


def changes(winners: Indices) -> Mask:
    """Tell which winners of a sequence (n,) differ from the one before, shape (n,); the first always does."""
    changed = np.ones(len(winners), dtype=bool)
    changed[1:] = winners[1:] != winners[:-1]
    return changed


def without_repeats(winners: Indices) -> Indices:
    """Drop consecutive duplicates from a sequence of winners (n,)."""
    kept: Indices = winners[changes(winners)]
    return kept


def resampled(path: Array, points: int) -> Array:
    """Place points along a polyline (n, 2) of length Δ, Δ / (points − 1) apart along it. Shape (points, 2).

    The path's ends are kept exactly. A path of one point, a still posture, becomes that point repeated.

    Raises:
        ValueError: the path has no point, or fewer than two are asked for.
    """
    if not len(path) or points < 2:
        raise ValueError(
            f"cannot place {points} points along a path of {len(path)} points: at least 2 points and a path of at "
            "least 1 point are needed"
        )
    lengths = np.hypot(*np.diff(path, axis=0).T)
    arc_lengths = np.concatenate(([0.0], np.cumsum(lengths)))
    targets = np.linspace(0.0, arc_lengths[-1], points)
    return np.stack([np.interp(targets, arc_lengths, axis) for axis in path.T], axis=1)


def ordered_vector(path: Array, points: int) -> Array:
    """Concatenate the resampled points of a path (n, 2) to the second layer's input, shape (2 * points,).

    Raises:
        ValueError: the path has no point, or fewer than two are asked for.
    """
    return resampled(path, points).ravel()
