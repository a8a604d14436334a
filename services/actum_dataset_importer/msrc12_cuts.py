"""Where a gesture of MSRC-12 starts and ends: the set annotates only its action point.

Two repetitions part where, between their action points, the actor moves least and is nearest to the pose between
repetitions. What is left about a point is trimmed where the actor stands still near that pose.
"""

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
"""Distance to the pose between repetitions below which the actor counts as near it, as a share of its greatest."""
RESTING_SHARE = 1 / 6
"""How far from half-way between two points the pose between repetitions is looked for, as a share of the way."""
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


def read_trimmed(path: Path, name: str, sensor: str) -> Take:
    """Read one stream and mark each repetition from where it starts to where it ends.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    stream = stored_stream(path, name)
    stamps_us = stream.stamps_us.tolist()
    spans_us = [None if cut is None else (stamps_us[cut.start], stamps_us[cut.end]) for cut in cuts_of(stream)]
    take = take_of(stream, spans_us, sensor)
    points = enumerate((stream.points_us * 1000).tolist())
    take.set_action_points({stream.segment_id(i): stamp_ns for i, stamp_ns in points if spans_us[i] is not None})
    return take


def cuts_of(stream: Stream) -> list[Cut | None]:
    """Cut a stream into its repetitions, one for each action point; None where nobody was found long enough."""
    seen = np.flatnonzero(stream.seen)
    if len(seen) < FEWEST_FRAMES or not len(stream.points_us):
        return [None] * len(stream.points_us)
    stamps_us = stream.stamps_us[seen]
    poses_m = _smoothed(stream.xyz_mm[seen][:, KINECT_V1_20] / 1000)
    poses_m -= poses_m[:, [INDEX["torso"]]]
    speeds = _speeds(poses_m, stamps_us)
    distances = _mean_distance(poses_m - _resting_pose(poses_m, stamps_us, stream.points_us))
    unrest = speeds / (np.median(speeds) + EPSILON) + distances / (np.median(distances) + EPSILON)
    parts = _parts(unrest, stamps_us, stream.points_us)
    return [None if part is None else _trimmed(seen, *part, speeds, distances) for part in parts]


def _parts(unrest: Floats, stamps_us: NDArray[np.int64], points_us: NDArray[np.int64]) -> list[tuple[int, int] | None]:
    """Return first and last frame about each point: those of least unrest towards the points beside it."""
    reach_us = int(np.median(np.diff(points_us))) if len(points_us) > 1 else REACH_US
    bounds_us = [int(points_us[0]) - reach_us, *points_us.tolist(), int(points_us[-1]) + reach_us]
    parting = [_least(unrest, stamps_us, *between_us) for between_us in pairwise(bounds_us)]
    return [
        (first, last) if first is not None and last is not None and last - first >= FEWEST_FRAMES else None
        for first, last in pairwise(parting)
    ]


def _least(unrest: Floats, stamps_us: NDArray[np.int64], start_us: int, end_us: int) -> int | None:
    """Return the index of least unrest between two instants; None where there is no frame."""
    between = np.flatnonzero((stamps_us >= start_us) & (stamps_us <= end_us))
    return int(between[unrest[between].argmin()]) if len(between) else None


def _trimmed(seen: NDArray[np.intp], first: int, last: int, speeds: Floats, distances: Floats) -> Cut:
    own = slice(first, last + 1)
    still = speeds[own] < STILL * speeds[own].max()
    near = distances[own] < NEAR * distances[own].max()
    acting = np.flatnonzero(~(still & near))
    start, end = (first + int(acting[0]), first + int(acting[-1])) if len(acting) > 1 else (first, last)
    return Cut(int(seen[first]), int(seen[start]), int(seen[end]), int(seen[last]))


def _resting_pose(poses_m: Floats, stamps_us: NDArray[np.int64], points_us: NDArray[np.int64]) -> Floats:
    """Return the median pose (15, 3) about half-way between action points."""
    if len(points_us) < 2:
        middle: Floats = np.median(poses_m, axis=0)
        return middle
    halfway_us = (points_us[1:] + points_us[:-1]) / 2
    nearby_us = RESTING_SHARE * np.median(np.diff(points_us))
    resting = np.abs(stamps_us[:, None] - halfway_us).min(axis=1) < nearby_us
    pose: Floats = np.median(poses_m[resting] if resting.any() else poses_m, axis=0)
    return pose


def _speeds(poses_m: Floats, stamps_us: NDArray[np.int64]) -> Floats:
    """Return the joints' mean speed (m/s) at each of the poses (n, 15, 3)."""
    speeds: Floats = _mean_distance(np.gradient(poses_m, axis=0)) / np.gradient(stamps_us * 1000 / SECOND_NS)
    return speeds


def _mean_distance(vectors_m: Floats) -> Floats:
    distances: Floats = np.linalg.norm(vectors_m, axis=2).mean(axis=1)
    return distances


def _smoothed(poses_m: Floats) -> Floats:
    """Average poses (n, 15, 3) over `SMOOTHED_FRAMES`, the first and last repeated beyond the ends."""
    half = SMOOTHED_FRAMES // 2
    padded = np.concatenate([poses_m[:1].repeat(half, axis=0), poses_m, poses_m[-1:].repeat(half, axis=0)])
    mean: Floats = np.mean([padded[i : i + len(poses_m)] for i in range(SMOOTHED_FRAMES)], axis=0)
    return mean
