"""A take of hands and objects as arrays, that it may be changed, and back as messages."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.messages import Hand, Message, Objects, Posture, Segment, Truth
from actum.skeletons import INDEX
from actum_dataset_importer.bimacs import HandsTake

Array = NDArray[np.float64]
HANDS: tuple[Hand, Hand] = ("left", "right")
EGO = np.array([-1.0, -1.0, 1.0])
"""The takes' egocentric axes, left, up, forward, in those of their camera frame, right, down, forward."""


@dataclass(frozen=True)
class Tracks:
    """A take as arrays over T frames: stamps (T,), hands (T, 3) with NaN where lost, objects by id, camera frame.

    `turned` (T, 3, 3) are the objects' orientations, `seen` (T,) tells where an object was seen; `bounds` are each
    segment's start and end in nanoseconds, `actors` its hand.
    """

    stamps_ns: NDArray[np.int64]
    hands: Mapping[Hand, Array]
    objects: Mapping[int, Array]
    turned: Mapping[int, Array]
    seen: Mapping[int, NDArray[np.bool_]]
    bounds: Mapping[str, tuple[int, int]]
    actors: Mapping[str, Hand]


def read(take: HandsTake) -> Tracks:
    starts = {m.segment_id: m for m in take.marks if m.kind == "start"}
    ends = {m.segment_id: m for m in take.marks if m.kind == "end"}
    ids = sorted({found.id for frame in take.objects for found in frame.objects})
    listed = [{found.id: found for found in frame.objects} for frame in take.objects]
    lost = (np.full(3, np.nan), np.eye(3), False)
    rows = {
        i: [(f[i].position_m, _matrix(f[i].quaternion_xyzw), f[i].seen) if i in f else lost for f in listed]
        for i in ids
    }
    return Tracks(
        np.array([posture.stamp_ns for posture in take.postures]),
        {hand: np.array([_hand(posture, hand) for posture in take.postures]) for hand in HANDS},
        {i: np.array([row[0] for row in of]) for i, of in rows.items()},
        {i: np.array([row[1] for row in of]) for i, of in rows.items()},
        {i: np.array([row[2] for row in of]) for i, of in rows.items()},
        {name: (start.stamp_ns or 0, ends[name].stamp_ns or 0) for name, start in starts.items()},
        {name: start.hand or "right" for name, start in starts.items()},
    )


def _hand(posture: Posture, hand: Hand) -> Array:
    joint = (posture.joints_m or [None] * len(INDEX))[INDEX[f"{hand}_hand"]]
    return np.full(3, np.nan) if joint is None else EGO * joint


def _matrix(quaternion_xyzw: Sequence[float]) -> Array:
    x, y, z, w = quaternion_xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def written(take: HandsTake, tracks: Tracks) -> list[Message]:
    """Write a take anew with what the tracks say; orientations are left as they were, which fusion does not ask for."""
    postures = [_posture(posture, tracks, k) for k, posture in enumerate(take.postures)]
    objects = [_objects(frame, tracks, k) for k, frame in enumerate(take.objects)]
    marks = [_mark(mark, tracks) for mark in take.marks]
    truths: list[Truth] = [t.model_copy(update={"stamp_ns": tracks.bounds[t.segment_id][1]}) for t in take.truths]
    return [*postures, *objects, *marks, *truths]


def _posture(posture: Posture, tracks: Tracks, k: int) -> Posture:
    joints = list(posture.joints_m or [])
    for hand, path in tracks.hands.items():
        joints[INDEX[f"{hand}_hand"]] = (EGO * path[k]).tolist() if np.isfinite(path[k]).all() else None
    return posture.model_copy(update={"stamp_ns": int(tracks.stamps_ns[k]), "joints_m": joints})


def _objects(frame: Objects, tracks: Tracks, k: int) -> Objects:
    listed = [
        found.model_copy(
            update={"position_m": tracks.objects[found.id][k].tolist(), "seen": bool(tracks.seen[found.id][k])}
        )
        for found in frame.objects
    ]
    return frame.model_copy(update={"stamp_ns": int(tracks.stamps_ns[k]), "objects": listed})


def _mark(mark: Segment, tracks: Tracks) -> Segment:
    stamp_ns = tracks.bounds[mark.segment_id][mark.kind == "end"]
    return mark.model_copy(update={"stamp_ns": stamp_ns, "hand": tracks.actors[mark.segment_id]})
