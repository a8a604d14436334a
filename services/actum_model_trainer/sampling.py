"""A selection of what recordings hold that fits into memory, however much there is: recordings are read one by one.

What is kept is drawn by hashes of names, without the folder: the same recordings give the same selection, wherever they
lie and in whatever order they are read. All is kept of what fits.
"""

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from actum.messages import NONE
from actum.recording import Recording
from actum_model_trainer.background import ARRAYS
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.sample_reading import each_read
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample, Unusable

MOST_SEGMENTS = 10_000
"""Labelled segments that are kept, as many of each action as possible: with 100 actions 100 of each. Each takes about
60 kB of memory."""
MOST_STREAM_FRAMES = 300_000
"""Frames of people's streams that are kept, nearly three hours: what the search learns from and is tuned on."""

LONGEST_PIECE = 20_000
"""Frames of a stream that are held together, ten minutes: the first layer's activity takes ten kilobytes a frame."""


@dataclass
class Sampling:
    """What is kept of the samples so far.

    Attributes:
        read: usable segments of each action so far, those not kept included. Those labelled none of the actions are
            not among them: what they teach lies in the streams.
        frames_read: frames of streams so far.
    """

    read: Counter[str] = field(default_factory=Counter)
    frames_read: int = 0
    _segments: dict[str, list[tuple[int, int, SegmentSample]]] = field(default_factory=dict)
    _streams: list[tuple[int, int, LabelledStream]] = field(default_factory=list)
    _unusable: list[tuple[int, Unusable]] = field(default_factory=list)
    _numbered: int = 0
    _first_dropped: int | None = None

    def add(self, more: Samples) -> None:
        """Keep what fits of the samples of one more recording, and drop what fits no longer."""
        for segment in more.segments:
            self._numbered += 1
            if isinstance(segment, Unusable):
                self._unusable.append((self._numbered, segment))
            elif segment.label != NONE:
                self.read[segment.label] += 1
                drawn = _drawn(segment.file, segment.person, segment.sensor, segment.segment_id)
                self._segments.setdefault(segment.label, []).append((drawn, self._numbered, segment))
        for piece in (piece for stream in more.streams for piece in pieces(stream)):
            self._numbered += 1
            self.frames_read += len(piece.stamps_ns)
            drawn = _drawn(piece.file, piece.person, piece.agent, *piece.stamps_ns[:1])
            self._streams.append((drawn, self._numbered, piece))
        self._drop_segments()
        self._drop_streams()

    @property
    def samples(self) -> Samples:
        """What is kept, in the order in which it was read."""
        segments: list[tuple[int, SegmentSample | Unusable]] = [*self._unusable]
        segments += [(order, each) for of_label in self._segments.values() for _, order, each in of_label]
        ordered = sorted(segments, key=lambda each: each[0])
        streams = sorted(self._streams, key=lambda each: each[1])
        return Samples([each for _, each in ordered], [each for _, _, each in streams])

    @property
    def remark(self) -> str | None:
        """A sentence that says how much is kept; None where all is."""
        segments = sum(map(len, self._segments.values()))
        frames = sum(len(stream.stamps_ns) for _, _, stream in self._streams)
        if (segments, frames) == (self.read.total(), self.frames_read):
            return None
        return (
            f"Training uses {segments} of {self.read.total()} labelled segments and {frames} of {self.frames_read} "
            "frames of whole recordings, drawn evenly: more would not fit into memory."
        )

    def _drop_segments(self) -> None:
        """Keep as many of each action as fit of all that were read: the more are read, the fewer."""
        quota = even_quota(list(self.read.values()), MOST_SEGMENTS)
        for label, of_label in self._segments.items():
            if len(of_label) > quota:
                self._segments[label] = sorted(of_label, key=lambda each: each[:2])[:quota]

    def _drop_streams(self) -> None:
        """Keep as many streams as fit, and none that is drawn after one that was dropped, even if it is short."""
        self._streams.sort(key=lambda each: each[:2])
        ends = np.cumsum([len(stream.stamps_ns) for _, _, stream in self._streams])
        for number, (drawn, _, _) in enumerate(self._streams):
            dropped = self._first_dropped is not None and drawn >= self._first_dropped
            if dropped or (number and ends[number] > MOST_STREAM_FRAMES):
                self._first_dropped = drawn if self._first_dropped is None else min(drawn, self._first_dropped)
                del self._streams[number:]
                break


def sampled_from(recordings: Sequence[Recording], progress: Progress = silent) -> Sampling:
    """Read recordings one by one, and keep of each what fits.

    Raises:
        RecordingError: a file is damaged.
    """
    sampling = Sampling()
    for samples in each_read(recordings, progress):
        sampling.add(samples)
    return sampling


def pieces(stream: LabelledStream) -> list[LabelledStream]:
    """Cut a long stream where no labelled segment is, if there is such a place, into pieces of `LONGEST_PIECE`."""
    firsts, frames = [0], len(stream.stamps_ns)
    while frames - firsts[-1] > LONGEST_PIECE:
        firsts.append(_cut(stream, firsts[-1]))
    bounds = zip(firsts, [*firsts[1:], frames], strict=True)
    return [_piece(stream, *each) for each in bounds] if len(firsts) > 1 else [stream]


def _cut(stream: LabelledStream, first: int) -> int:
    """Return the frame at which the next piece begins."""
    stamps_ns = stream.stamps_ns[first + LONGEST_PIECE // 2 : first + LONGEST_PIECE + 1]
    free = np.ones(len(stamps_ns), dtype=bool)
    for start_ns, end_ns, _ in stream.segments:
        free[slice(*np.searchsorted(stamps_ns, (start_ns, end_ns + 1)).tolist())] = False
    return first + LONGEST_PIECE // 2 + int(np.flatnonzero(free)[-1] if free.any() else len(free) - 1)


def _piece(stream: LabelledStream, first: int, after: int) -> LabelledStream:
    """Return some of a stream's frames, in memory of their own, and the segments that begin there.

    A segment that begins before the first frame belongs to the first piece, one between two pieces to the second.
    """
    arrays = {name: getattr(stream, name)[first:after].copy() for name in ("stamps_ns", *ARRAYS)}
    stamps_ns = stream.stamps_ns
    own = [each for each in stream.segments if not first or each[0] > stamps_ns[first - 1]]
    own = [each for each in own if after == len(stamps_ns) or each[0] <= stamps_ns[after - 1]]
    return replace(stream, segments=tuple(own), **arrays)


def even_quota(counts: Sequence[int], most: int) -> int:
    """Return the largest number of each kind that may be kept so that all together are no more than `most`.

    Kinds that have fewer leave their room to the others. At least one of each is kept.
    """
    left, kinds = most, len(counts)
    for count in sorted(counts):
        if count * kinds > left:
            return max(left // kinds, 1)
        left, kinds = left - count, kinds - 1
    return max(counts, default=most)


def _drawn(file: str, *names: object) -> int:
    """Return a number that is as good as drawn, the same for the same names and file, in whatever folder it lies."""
    name = "\0".join(map(str, (Path(file).name, *names)))
    return int.from_bytes(hashlib.blake2b(name.encode(), digest_size=8).digest(), "big")
