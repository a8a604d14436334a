"""One take of a public skeleton set, and the source that plays takes one after another."""

import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain, groupby
from operator import attrgetter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from actum.joining import joined
from actum.messages import Message, Segment, Skeleton
from actum.node import SECOND_NS, Source, Tally


class DatasetError(ValueError):
    """A file or folder is not what the set's documentation says: which, what is wrong, what to do."""


@dataclass(frozen=True)
class Take:
    """One recorded file: its frames, and its labelled segments as start and end marks.

    `fields` is free metadata of a recording; `notes` counts what reading it dropped or found odd, by kind; `skipped`
    names the segments that could not be marked.
    """

    name: str
    person: str
    frames: list[Skeleton]
    marks: list[Segment] = field(default_factory=list)
    fields: dict[str, str] = field(default_factory=dict)
    notes: Counter[str] = field(default_factory=Counter)
    skipped: list[str] = field(default_factory=list)


class TakesSource:
    """Plays takes in a row at the sensor's pace; `read` turns a file and the sensor's name into a take."""

    name = "sensor_gateway"
    paced = True

    def __init__(self, paths: list[Path], sensor: str, read: Callable[[Path, str], Take]) -> None:
        self.tally = Tally()
        self._paths = paths
        self._sensor = sensor
        self._read = read

    def frames(self) -> Iterator[list[Message]]:
        """Yield one skeleton frame after another; between two takes the stamps rise by a second or more."""
        return instants(joined(self._take(path) for path in self._paths))

    def _take(self, path: Path) -> list[Skeleton]:
        take = self._read(path, self._sensor)
        for kind, count in take.notes.items():
            self.tally.rejects[kind] += count
        return take.frames


class LoopedSource:
    """Another source from files, played again and again: stamps and numbers go on rising."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.name, self.paced, self.tally = source.name, source.paced, source.tally

    def frames(self) -> Iterator[list[Message]]:
        """Yield the source's frames for ever; none where it has none."""
        return instants(joined(self._rounds()))

    def _rounds(self) -> Iterator[Iterable[Message]]:
        while (first := next(frames := self._source.frames(), None)) is not None:
            yield chain(first, chain.from_iterable(frames))


def instants(messages: Iterator[Message]) -> Iterator[list[Message]]:
    """Group neighbours that have the same stamp."""
    for _, group in groupby(messages, key=attrgetter("stamp_ns")):
        yield list(group)


def files_of(path: Path, pattern: str) -> list[Path]:
    """Return the file itself, or the folder's files of that pattern in order of name.

    Raises:
        DatasetError: there is none.
    """
    files = [path] if path.is_file() else sorted(path.glob(pattern))
    if not files:
        raise DatasetError(f"{path}: no {pattern} there; name such a file or the folder that holds them")
    return files


def read_rows(path: Path, columns: int) -> NDArray[np.float64]:
    """Read a text file of numbers, shape (rows, columns), all finite.

    Raises:
        DatasetError: it is anything else.
    """
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")
            rows = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: not rows of {columns} numbers ({error}); fetch it anew") from None
    if rows.shape[0] == 0 or rows.shape[1] != columns or not np.isfinite(rows).all():
        raise DatasetError(f"{path}: not rows of {columns} finite numbers; fetch it anew")
    return rows


def lost_frame(stamp_ns: int, sensor: str, session_id: str) -> Skeleton:
    """Return a frame in which the set has nobody."""
    reason = "no skeleton in the source"
    return Skeleton(stamp_ns=stamp_ns, sensor=sensor, valid=False, reason=reason, agents=[], session_id=session_id)


def marks_between(start_ns: int, end_ns: int, sensor: str, segment_id: str, label: str) -> list[Segment]:
    """Return the start and the end mark of a labelled segment."""
    return [
        Segment(stamp_ns=start_ns, sensor=sensor, kind="start", segment_id=segment_id, label=label),
        Segment(stamp_ns=end_ns, sensor=sensor, kind="end", segment_id=segment_id),
    ]


def camera_joints(positions_m: list[list[float]]) -> list[list[float] | None]:
    """Turn positions (x left, y up, z forward; m) into joints in the camera frame (x right, y down, z forward)."""
    return [[-x, -y, z] for x, y, z in positions_m]


def stamp_of(index: int, per_second: int) -> int:
    """Return the stamp (ns, to the nearest) of a frame counted at a fixed rate."""
    return (2 * index * SECOND_NS + per_second) // (2 * per_second)
