"""Where a gesture of MSRC-12 starts and ends: the set annotates only its action point.

Two repetitions part where, between their action points, the actor moves least and is nearest to the pose of rest. What
is left about a point is trimmed where the actor stands still near that pose.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.skeletons import INDEX, KINECT_V1_20
from actum_dataset_importer.msrc12 import REACH_US, Stream, stored_stream, take_of
from actum_dataset_importer.takes import Take

Floats = NDArray[np.float64]

SMOOTHED_FRAMES = 5
"""Frames that a pose is averaged over, a sixth of a second: less than any gesture lasts, more than the jitter."""
STILL = 0.25
"""Speed below which the actor counts as still, as a share of the repetition's greatest."""
NEAR = 0.5
"""Distance to the pose of rest below which the actor counts as near it, as a share of the repetition's greatest."""
RESTING_SHARE = 0.25
"""The share of each stream's frames, the slowest, among which a person's pose of rest is looked for: in some gestures
nobody rests between two repetitions, but over all gestures people rest alike."""
FEWEST_FRAMES = 8
"""Frames that a repetition has at least: a quarter of a second."""
EPSILON = 1e-9
"""Keeps a body that never moves from a division by zero (m/s, m)."""


@dataclass(frozen=True)
class Cut:
    """One repetition: indices of the stream's frames, all inclusive.

    Attributes:
        first: where the repetition before it ends.
        start: where the actor begins to move.
        end: where the actor has stopped.
        last: where the next repetition begins.
    """

    first: int
    start: int
    end: int
    last: int


@dataclass(frozen=True, eq=False)
class Movement:
    """How the person of a stream moves, where anybody was found.

    Attributes:
        frames: (n,), indices of the stream's frames.
        stamps_us: (n,), of these.
        poses_m: (n, 15, 3), from the torso, smoothed.
        speeds: (n,), the joints' mean speed, m/s.
    """

    frames: NDArray[np.intp]
    stamps_us: NDArray[np.int64]
    poses_m: Floats
    speeds: Floats


def trimmed(path: Path, names: Sequence[str], sensor: str) -> Iterator[Take]:
    """Read the streams of one person's file and mark each repetition from where it starts to where it ends.

    Raises:
        DatasetError: a name or the content is not of the set's form.
    """
    streams = [stored_stream(path, name) for name in names]
    rest_m = resting_pose(streams)
    for stream in streams:
        stamps_us = stream.stamps_us.tolist()
        cuts = cuts_of(stream, rest_m)
        spans_us = [None if cut is None else (stamps_us[cut.start], stamps_us[cut.end]) for cut in cuts]
        take = take_of(stream, spans_us, sensor)
        points = zip(cuts, (stream.points_us * 1000).tolist(), strict=True)
        take.set_action_points({stream.segment_id(i): ns for i, (cut, ns) in enumerate(points) if cut is not None})
        yield take


def resting_pose(streams: Iterable[Stream]) -> Floats:
    """Return the pose of rest of a person, (15, 3) in metres from the torso, by all of their streams."""
    slow = [np.zeros((0, len(KINECT_V1_20), 3))]
    for stream in streams:
        movement = _movement(stream)
        if movement is not None:
            slow.append(movement.poses_m[movement.speeds <= np.quantile(movement.speeds, RESTING_SHARE)])
    pose: Floats = np.median(np.concatenate(slow), axis=0) if len(slow) > 1 else np.zeros((len(KINECT_V1_20), 3))
    return pose


def cuts_of(stream: Stream, rest_m: Floats) -> list[Cut | None]:
    """Cut a stream into its repetitions, one for each action point, given the pose of rest (15, 3) from the torso (m).

    None stands for one in which nobody was found long enough.
    """
    movement = _movement(stream)
    if movement is None or not len(stream.points_us):
        return [None] * len(stream.points_us)
    speeds, distances = movement.speeds, _mean_distance(movement.poses_m - rest_m)
    unrest = speeds / (np.median(speeds) + EPSILON) + distances / (np.median(distances) + EPSILON)
    points_us = stream.points_us
    reach_us = int(np.median(np.diff(points_us))) if len(points_us) > 1 else REACH_US
    bounds_us = [int(points_us[0]) - reach_us, *points_us.tolist(), int(points_us[-1]) + reach_us]
    parting = [_least(unrest, movement.stamps_us, *between_us) for between_us in pairwise(bounds_us)]
    parts = [
        (first, last) if first is not None and last is not None and last - first >= FEWEST_FRAMES else None
        for first, last in pairwise(parting)
    ]
    return [None if part is None else _trimmed(movement, *part, distances) for part in parts]


def _movement(stream: Stream) -> Movement | None:
    """Return how a stream's person moves; None where hardly anybody was found."""
    frames = np.flatnonzero(stream.seen)
    if len(frames) < FEWEST_FRAMES:
        return None
    stamps_us = stream.stamps_us[frames]
    poses_m = _smoothed(stream.xyz_mm[frames][:, KINECT_V1_20] / 1000)
    poses_m -= poses_m[:, [INDEX["torso"]]]
    speeds = _mean_distance(np.gradient(poses_m, axis=0)) / np.gradient(stamps_us * 1000 / SECOND_NS)
    return Movement(frames, stamps_us, poses_m, speeds)


def _least(unrest: Floats, stamps_us: NDArray[np.int64], start_us: int, end_us: int) -> int | None:
    """Return the index of least unrest between two instants; None where there is no frame."""
    between = np.flatnonzero((stamps_us >= start_us) & (stamps_us <= end_us))
    return int(between[unrest[between].argmin()]) if len(between) else None


def _trimmed(movement: Movement, first: int, last: int, distances: Floats) -> Cut:
    own = slice(first, last + 1)
    still = movement.speeds[own] < STILL * movement.speeds[own].max()
    near = distances[own] < NEAR * distances[own].max()
    acting = np.flatnonzero(~(still & near))
    start, end = (first + int(acting[0]), first + int(acting[-1])) if len(acting) > 1 else (first, last)
    return Cut(*(int(movement.frames[i]) for i in (first, start, end, last)))


def _mean_distance(vectors_m: Floats) -> Floats:
    distances: Floats = np.linalg.norm(vectors_m, axis=2).mean(axis=1)
    return distances


def _smoothed(poses_m: Floats) -> Floats:
    """Average poses (n, 15, 3) over `SMOOTHED_FRAMES`, the first and last repeated beyond the ends."""
    half = SMOOTHED_FRAMES // 2
    padded = np.concatenate([poses_m[:1].repeat(half, axis=0), poses_m, poses_m[-1:].repeat(half, axis=0)])
    mean: Floats = np.mean([padded[i : i + len(poses_m)] for i in range(SMOOTHED_FRAMES)], axis=0)
    return mean
