"""Depth alignment: shift objects along their line of sight to the hand, as far as the body's depth is uncertain.

A body whose distance is estimated from its size alone is too near or too far by about the same amount for a whole
segment, while its error across the line of sight is small. So where a hand comes to an object in the image, the gap
between them in depth may be the error of the body's depth.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from action_fusion.settings import Settings
from action_fusion.tracks.hand_tracks import HandTrack
from action_fusion.tracks.object_tracks import ObjectTrack
from actum.arrays import Array

ACROSS_STD_M = 0.05
"""Standard deviation of a hand's distance from an object across the line of sight."""

LIKELY_STD = 2.0
"""Largest gap in depth, in standard deviations, that may be the body's error; a larger one is real."""


def aligned_in_depth(
    tracks: Sequence[ObjectTrack], hands: Collection[HandTrack], depth_std_m: float, settings: Settings
) -> list[ObjectTrack]:
    """Shift all positions of each object along its line of sight, towards the hand that came nearest to it.

    With a the distance across and d along the line of sight and s_a, s_d their standard deviations, the nearest
    instant is that of the smallest a²/s_a² + d²/(s_a² + s_d²). The shift is the share s_d²/(s_a² + s_d²) of d at
    that instant. An object is not shifted if no hand came within reach of it across the line of sight.
    """
    if depth_std_m == 0:
        return list(tracks)
    shifts = [_shift_m(track, hands, depth_std_m, settings) for track in tracks]
    return [
        replace(track, positions_m=track.positions_m + shift_m, depth_shift_m=shift_m)
        for track, shift_m in zip(tracks, shifts, strict=True)
    ]


def _shift_m(track: ObjectTrack, hands: Collection[HandTrack], depth_std_m: float, settings: Settings) -> Array:
    """Compute the shift (3,) of an object in metres, in the camera frame."""
    hands_m = np.concatenate([hand.positions_m[hand.in_segment] for hand in hands] or [np.empty((0, 3))])
    stamps_ns = np.concatenate([hand.stamps_ns[hand.in_segment] for hand in hands] or [np.empty(0)])
    objects_m = track.at(stamps_ns)
    rays = objects_m / np.maximum(np.linalg.norm(objects_m, axis=1, keepdims=True), ACROSS_STD_M)
    along_m = np.einsum("ij,ij->i", hands_m - objects_m, rays)
    across_m = np.linalg.norm(hands_m - objects_m - along_m[:, None] * rays, axis=1)
    variance = ACROSS_STD_M**2 + depth_std_m**2
    likely = (across_m <= settings.reach_m) & (np.abs(along_m) <= LIKELY_STD * np.sqrt(variance))
    if not likely.any():
        return np.zeros(3)
    nearest = int(np.argmin(np.where(likely, (across_m / ACROSS_STD_M) ** 2 + along_m**2 / variance, np.inf)))
    shift_m: Array = depth_std_m**2 / variance * along_m[nearest] * rays[nearest]
    return shift_m
