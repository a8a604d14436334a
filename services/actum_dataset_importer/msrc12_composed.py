"""Streams composed of MSRC-12: one person does all gestures in mixed order, as they would in front of a live camera.

Each stream has two repetitions of each gesture, none the first or the last of its file, in an order in which neighbours
differ. Each piece reaches from where the repetition before it ended to where the next one began in its own file: rests
stay between them. Pieces are moved horizontally to where the first one began, and joined by interpolated frames.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.messages import Segment, segment_marks
from actum.node import SECOND_NS
from actum.skeletons import INDEX, KINECT_V1_20
from actum_dataset_importer.msrc12 import Stream, stored_stream
from actum_dataset_importer.msrc12_cuts import cuts_of, resting_pose
from actum_dataset_importer.takes import DatasetError, Take, frame_of_person, stamp_of

Floats = NDArray[np.float64]

STREAMS = 2
"""Streams of each person: most people did each gesture often enough for two."""
REPETITIONS = 2
"""Repetitions of each gesture in a stream."""
JOINING_FRAMES = 6
"""Interpolated frames between two pieces: a fifth of a second, in which people change their pose."""
RATE_HZ = 30
"""Frames a second, Kinect's: frames are taken as they are and stamped evenly."""
SEED = 0
"""Of the drawing and the order; each person's number is added."""
_TORSO = KINECT_V1_20[INDEX["torso"]]
_HORIZONTAL = [0, 2]


@dataclass(frozen=True, eq=False)
class Piece:
    """One repetition with the rest about it.

    Attributes:
        segment_id: of its file and action point.
        joints_m: (n, 20, 3), in the set's axes.
        start: index of the frame at which the gesture starts.
        end: index of the frame at which it ends.
        point: where its action point lies, in frames; between two frames where the point does.
    """

    segment_id: str
    label: str
    joints_m: Floats
    start: int
    end: int
    point: float


def composed(path: Path, names: Sequence[str], sensor: str) -> Iterator[Take]:
    """Compose the streams of one person's file, given the names of all streams in it.

    Raises:
        DatasetError: the file is not of the set's form, or its gestures cannot be mixed.
    """
    streams = [stored_stream(path, name) for name in names]
    rest_m = resting_pose(streams)
    repeated: dict[str, list[Piece]] = {}
    for stream in streams:
        repeated.setdefault(stream.label, []).extend(pieces_of(stream, rest_m))
    person = streams[0].person
    rng = np.random.default_rng([SEED, int(person)])
    drawn = {label: [of_one[i] for i in rng.permutation(len(of_one))] for label, of_one in sorted(repeated.items())}
    for number in range(STREAMS):
        own = slice(number * REPETITIONS, (number + 1) * REPETITIONS)
        pieces = [piece for of_one in drawn.values() for piece in of_one[own]]
        labels = [piece.label for piece in pieces]
        if not labels or 2 * max(map(labels.count, labels)) > len(labels) + 1:
            raise DatasetError(
                f"{path} contains too few different gestures for a composed recording: leave out --composed"
            )
        yield _joined(mixed(pieces, rng), f"composed_p{int(person):02d}_{number + 1}", person, sensor)


def pieces_of(stream: Stream, rest_m: Floats) -> list[Piece]:
    """Return a stream's repetitions but for the first and the last, where all of them was seen.

    `rest_m` is the person's pose of rest (15, 3) from the torso.
    """
    cuts = list(enumerate(zip(cuts_of(stream, rest_m), stream.points_us, strict=True)))[1:-1]
    return [
        Piece(
            stream.segment_id(number),
            stream.label,
            stream.xyz_mm[cut.first : cut.last + 1] / 1000,
            cut.start - cut.first,
            cut.end - cut.first,
            float(np.interp(point_us, stream.stamps_us, np.arange(len(stream.stamps_us)))) - cut.first,
        )
        for number, (cut, point_us) in cuts
        if cut is not None and stream.seen[cut.first : cut.last + 1].all()
    ]


def mixed(pieces: Sequence[Piece], rng: np.random.Generator) -> list[Piece]:
    """Shuffle pieces until no two neighbours are of the same gesture; there must be such an order."""
    while True:
        order = [pieces[i] for i in rng.permutation(len(pieces))]
        if all(before.label != after.label for before, after in pairwise(order)):
            return order


def _joined(pieces: Sequence[Piece], name: str, person: str, sensor: str) -> Take:
    pieces_m = [piece.joints_m for piece in pieces]
    moved = [piece_m.copy() for piece_m in pieces_m]
    for piece_m in moved:  # each begins where the first one begins, or the person would jump
        piece_m[..., _HORIZONTAL] += (pieces_m[0][0, _TORSO] - piece_m[0, _TORSO])[_HORIZONTAL]
    frames = np.concatenate(list(_with_frames_between(moved)))
    lengths = [len(piece.joints_m) + JOINING_FRAMES for piece in pieces]
    offsets = np.concatenate([[0], np.cumsum(lengths)[:-1]]).tolist()
    placed = list(zip(pieces, offsets, strict=True))
    take = Take(
        name,
        person=person,
        frames=[frame_of_person(stamp_of(i, RATE_HZ), frame, sensor, name) for i, frame in enumerate(frames)],
        marks=[mark for piece, offset in placed for mark in _marks(piece, offset, sensor)],
        metadata={"composed_of": "MSRC-12"},
    )
    take.set_action_points(
        {piece.segment_id: round((offset + piece.point) * SECOND_NS / RATE_HZ) for piece, offset in placed}
    )
    return take


def _marks(piece: Piece, offset: int, sensor: str) -> list[Segment]:
    start_ns, end_ns = stamp_of(offset + piece.start, RATE_HZ), stamp_of(offset + piece.end, RATE_HZ)
    return segment_marks(start_ns, end_ns, sensor, piece.segment_id, piece.label)


def _with_frames_between(pieces_m: Sequence[Floats]) -> Iterator[Floats]:
    """Yield the pieces (n, 20, 3) and, between them, the frames that join them."""
    for before, after in pairwise(pieces_m):
        yield before
        shares = np.arange(1, JOINING_FRAMES + 1)[:, None, None] / (JOINING_FRAMES + 1)
        yield (1 - shares) * before[-1] + shares * after[0]
    yield pieces_m[-1]
