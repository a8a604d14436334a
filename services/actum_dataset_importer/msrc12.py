"""MSRC-12: streams of one repeated gesture each, twenty joints, millimetres, x left and y up, with action points.

An action point is the instant at which a gesture can be recognised (Fothergill, Mentis, Kohli, Nowozin 2012); starts
and ends are not annotated. A segment lasts from half-way to the previous point to half-way to the next, at most 1.5 s
to either side. `p01.npz` holds a person's streams, of each three arrays: `NAME.xyz_mm` (frames, 20, 3), all zero where
nobody was found, `NAME.t_us` (frames,) and `NAME.tags_us` (points,), all integers.
"""

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from actum.messages import Segment, Skeleton, segment_marks
from actum_dataset_importer.takes import DatasetError, Take, files_of, frame_of_person, frame_without_person

Integers = NDArray[np.int64]

REACH_US = 1_500_000
"""Longest reach of a segment from its action point (µs): half the usual 3 s between two, where people move least."""

SOURCE_JOINTS = 20
"""Joints of Kinect's skeleton, of which fifteen are kept."""
PATTERN = "p*.npz"
PARTS = ("xyz_mm", "t_us", "tags_us")
DAMAGED = (OSError, ValueError, EOFError, BadZipFile, zlib.error)
"""What reading arrays raises on a file of another kind or a damaged one."""

NAME = re.compile(r"P(?P<instruction>\d)_(?P<set>\d)_(?P<gesture>(?P<number>\d+)A?)_p(?P<person>\d\d)")

GESTURES: tuple[str, ...] = (
    "lift arms",
    "duck",
    "push right",
    "goggles",
    "wind up",
    "shoot",
    "bow",
    "throw",
    "had enough",
    "change weapon",
    "beat both",
    "kick",
)
"""Names of the gestures 1 … 12."""


@dataclass(frozen=True, eq=False)
class Stream:
    """One stream as it is stored.

    Attributes:
        name: such as `P3_1_10A_p01`.
        xyz_mm: (frames, 20, 3).
        stamps_us: (frames,), rising.
        points_us: (points,), rising.
    """

    name: str
    xyz_mm: Integers
    stamps_us: Integers
    points_us: Integers

    @property
    def named(self) -> dict[str, str]:
        """The parts of its name, by kind: instruction, set, gesture, number, person."""
        match = NAME.fullmatch(self.name)
        assert match is not None
        return match.groupdict()

    @property
    def label(self) -> str:
        """The gesture that is repeated."""
        return GESTURES[int(self.named["number"]) - 1]

    @property
    def person(self) -> str:
        """Who acts."""
        return str(int(self.named["person"]))

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Whether anybody was found, by frame, (frames,)."""
        return np.asarray(self.xyz_mm.any(axis=(1, 2)))

    def segment_id(self, point: int) -> str:
        """Return the id of the segment about an action point, given its index."""
        return f"{self.name}-{point + 1:02d}"


def stream_names(path: Path) -> list[tuple[Path, str]]:
    """List the streams of one file, or of all of the set's folder, each with the file that holds it.

    Raises:
        DatasetError: there is no file, or one is damaged.
    """
    return [(file, name) for file in files_of(path, PATTERN) for name in _names(file)]


def stream_names_by_file(path: Path) -> dict[Path, list[str]]:
    """List the streams of each file, and so of each person.

    Raises:
        DatasetError: there is no file, or one is damaged.
    """
    names: dict[Path, list[str]] = {}
    for file, name in stream_names(path):
        names.setdefault(file, []).append(name)
    return names


def stored_stream(path: Path, name: str) -> Stream:
    """Read one stream.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    match = NAME.fullmatch(name)
    if match is None or not 1 <= int(match["number"]) <= len(GESTURES):
        raise DatasetError(f"{path}: the stream {name!r} is not named like P1_1_10A_p01: keep the data set's own names")
    try:
        with path.open("rb") as stored, np.load(stored) as arrays:
            xyz_mm, stamps_us, points_us = (arrays[f"{name}.{part}"] for part in PARTS)
    except (KeyError, *DAMAGED):
        raise DatasetError(f"{path}: the stream {name} is incomplete: download the file again") from None
    stamps_rise = stamps_us.size and (np.diff(stamps_us) > 0).all()
    if xyz_mm.shape != (len(stamps_us), SOURCE_JOINTS, 3) or not stamps_rise or not (np.diff(points_us) > 0).all():
        raise DatasetError(
            f"{path}: the stream {name} does not consist of frames of {SOURCE_JOINTS} joints with increasing time "
            "stamps: download the file again"
        )
    return Stream(name, xyz_mm, stamps_us, points_us)


def read_stream(path: Path, name: str, sensor: str) -> Take:
    """Read one stream and mark a segment about each action point; frames without a skeleton become invalid frames.

    Raises:
        DatasetError: the name or the content is not of the set's form.
    """
    stream = stored_stream(path, name)
    return take_of(stream, spans_about(stream.points_us, int(stream.stamps_us[0]), int(stream.stamps_us[-1])), sensor)


def take_of(stream: Stream, spans_us: Sequence[tuple[int, int] | None], sensor: str) -> Take:
    """Return a stream as a take, with a labelled segment from start to end (µs) for each of its action points.

    None stands for a segment that cannot be marked.
    """
    ids = {stream.segment_id(number): span_us for number, span_us in enumerate(spans_us)}
    return Take(
        stream.name,
        person=stream.person,
        frames=[_skeleton(*frame, sensor, stream.name) for frame in zip(stream.stamps_us, stream.xyz_mm, strict=True)],
        marks=[
            mark for segment_id, span_us in ids.items() for mark in _marks(span_us, sensor, segment_id, stream.label)
        ],
        metadata={kind: stream.named[kind] for kind in ("instruction", "set", "gesture")},
        skipped=[segment_id for segment_id, span_us in ids.items() if span_us is None],
    )


def spans_about(points_us: Integers, first_us: int, last_us: int) -> list[tuple[int, int] | None]:
    """Return start and end (µs) of the segment about each action point; None where the stream has no frames there.

    Args:
        points_us: (points,), rising.
        first_us, last_us: the stream's first and last stamp.
    """
    points = points_us.tolist()
    bounds = [first_us, *((before + after) // 2 for before, after in pairwise(points)), last_us]
    spans = [
        (max(start, point - REACH_US, first_us), min(end, point + REACH_US, last_us))
        for point, (start, end) in zip(points, pairwise(bounds), strict=False)  # no point: one pair of bounds
    ]
    return [span if span[0] < span[1] else None for span in spans]


def _names(file: Path) -> list[str]:
    try:
        with file.open("rb") as stored, np.load(stored) as arrays:
            return sorted({array.rpartition(".")[0] for array in arrays.files})
    except DAMAGED:
        raise DatasetError(f"{file} cannot be read as a file of MSRC-12 streams: download the file again") from None


def _skeleton(stamp_us: int, joints_mm: Integers, sensor: str, session_id: str) -> Skeleton:
    stamp_ns = int(stamp_us) * 1000
    if not joints_mm.any():
        return frame_without_person(stamp_ns, sensor, session_id)
    return frame_of_person(stamp_ns, joints_mm / 1000, sensor, session_id)


def _marks(span_us: tuple[int, int] | None, sensor: str, segment_id: str, label: str) -> list[Segment]:
    if span_us is None:
        return []
    start_us, end_us = span_us
    return segment_marks(1000 * start_us, 1000 * end_us, sensor, segment_id, label)
