"""Objects brought to the hand along the line of sight, as far as the body's distance is uncertain.

A body placed by its size alone stands nearer or further than it seems, by about the same for as long as a segment
lasts; across the line of sight it is seen exactly. What the hand came to in the image is at the hand, where the
distance between them may be the body's error.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from action_fusion.hands import HandPath
from action_fusion.samples import Array, PostureSample
from action_fusion.settings import Settings
from action_fusion.tracks import Track

ACROSS_STD_M = 0.05
"""How exactly hand and object are seen across the line of sight."""

LIKELY_STD = 2.0
"""An error of more standard deviations is none."""


def depth_std_m(postures: Sequence[PostureSample]) -> float:
    """Return how uncertain the body's distance is, the median over its postures; 0 where it was measured."""
    known = [sample.body.depth_std_m for sample in postures if sample.body is not None]
    return float(np.median(known)) if known else 0.0


def aligned(tracks: Sequence[Track], paths: Iterable[HandPath], std_m: float, settings: Settings) -> list[Track]:
    """Move each object along the line of sight towards the hand that it was nearest to, all its places alike.

    At the instant of the smallest a²/s_a² + d²/(s_a² + s_d²), a across and d along the line of sight, that is by the
    share s_d²/(s_a² + s_d²) of d; an object that no hand came within reach of in the image stays.
    """
    if std_m == 0:
        return list(tracks)
    taken = list(paths)
    shifts = [_shift(track, taken, std_m, settings) for track in tracks]
    return [replace(t, positions_m=t.positions_m + by, brought_m=by) for t, by in zip(tracks, shifts, strict=True)]


def _shift(track: Track, paths: Sequence[HandPath], std_m: float, settings: Settings) -> Array:
    """Return the displacement (3,), camera frame."""
    hands = np.concatenate([path.positions_m[path.stamps_ns >= 0] for path in paths] or [np.empty((0, 3))])
    stamps = np.concatenate([path.stamps_ns[path.stamps_ns >= 0] for path in paths] or [np.empty(0)])
    objects = track.at(stamps)
    sights = objects / np.maximum(np.linalg.norm(objects, axis=1, keepdims=True), ACROSS_STD_M)
    along = np.einsum("ij,ij->i", hands - objects, sights)
    across = np.linalg.norm(hands - objects - along[:, None] * sights, axis=1)
    variance = ACROSS_STD_M**2 + std_m**2
    likely = (across <= settings.reach_m) & (np.abs(along) <= LIKELY_STD * np.sqrt(variance))
    if not likely.any():
        return np.zeros(3)
    nearest = int(np.argmin(np.where(likely, (across / ACROSS_STD_M) ** 2 + along**2 / variance, np.inf)))
    shift: Array = std_m**2 / variance * along[nearest] * sights[nearest]
    return shift
