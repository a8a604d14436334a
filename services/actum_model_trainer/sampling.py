"""A selection of what recordings hold that fits into memory, however much there is: recordings are read one by one.

What is kept is drawn by hashes of its names: the same recordings give the same selection, in whatever order. All is
kept of what fits.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from actum.recording import Recording
from actum_model_trainer.background import ARRAYS
from actum_model_trainer.progress import Progress, silent
from actum_model_trainer.samples import LabelledStream, Samples, SegmentSample, Unusable, each_read

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
        segments_read: usable labelled segments so far, those not kept included.
        frames_read: frames of streams so far.
    """

    segments_read: int = 0
    frames_read: int = 0
    _segments: dict[str, list[tuple[int, int, SegmentSample]]] = field(default_factory=dict)
    _streams: list[tuple[int, int, LabelledStream]] = field(default_factory=list)
    _unusable: list[tuple[int, Unusable]] = field(default_factory=list)
    _read: int = 0

    def add(self, more: Samples) -> None:
        """Keep what fits of the samples of one more recording, and drop what fits no longer."""
        for segment in more.segments:
            self._read += 1
            if isinstance(segment, Unusable):
                self._unusable.append((self._read, segment))
            else:
                self.segments_read += 1
                drawn = _drawn(f"{segment.file}\0{segment.sensor}\0{segment.segment_id}")
                self._segments.setdefault(segment.label, []).append((drawn, self._read, segment))
        for piece in (piece for stream in more.streams for piece in pieces(stream)):
            self._read += 1
            self.frames_read += len(piece.stamps_ns)
            drawn = _drawn(f"{piece.file}\0{piece.agent}\0{piece.stamps_ns[0] if len(piece.stamps_ns) else 0}")
            self._streams.append((drawn, self._read, piece))
        self._drop()

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
        if (segments, frames) == (self.segments_read, self.frames_read):
            return None
        return (
            f"training uses {segments} of {self.segments_read} labelled segments and {frames} of {self.frames_read} "
            "frames of whole recordings, drawn evenly: more would not fit into memory"
        )

    def _drop(self) -> None:
        quota = even_quota([len(of_label) for of_label in self._segments.values()], MOST_SEGMENTS)
        for label, of_label in self._segments.items():
            if len(of_label) > quota:
                self._segments[label] = sorted(of_label, key=lambda each: each[:2])[:quota]
        frames = 0
        for number, (_, _, stream) in enumerate(sorted(self._streams, key=lambda each: each[:2])):
            frames += len(stream.stamps_ns)
            if frames > MOST_STREAM_FRAMES and number:
                self._streams = sorted(self._streams, key=lambda each: each[:2])[:number]
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
    found, first, frames = [], 0, len(stream.stamps_ns)
    while frames - first > LONGEST_PIECE:
        after = _cut(stream, first)
        found.append(_piece(stream, first, after))
        first = after
    return [*found, _piece(stream, first, frames)] if found else [stream]


def _cut(stream: LabelledStream, first: int) -> int:
    """Return the frame at which the next piece begins."""
    stamps_ns = stream.stamps_ns[first + LONGEST_PIECE // 2 : first + LONGEST_PIECE + 1]
    free = np.ones(len(stamps_ns), dtype=bool)
    for start_ns, end_ns, _ in stream.segments:
        free[slice(*np.searchsorted(stamps_ns, (start_ns, end_ns + 1)).tolist())] = False
    return first + LONGEST_PIECE // 2 + int(np.flatnonzero(free)[-1] if free.any() else len(free) - 1)


def _piece(stream: LabelledStream, first: int, after: int) -> LabelledStream:
    """Return some of a stream's frames, in memory of their own, and the segments that begin there."""
    arrays = {name: getattr(stream, name)[first:after].copy() for name in ("stamps_ns", *ARRAYS)}
    last_ns = arrays["stamps_ns"][-1]
    own = tuple(each for each in stream.segments if arrays["stamps_ns"][0] <= each[0] <= last_ns)
    return replace(stream, segments=own, **arrays)


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


def _drawn(name: str) -> int:
    """Return a number that is as good as drawn, the same for the same name."""
    return int.from_bytes(hashlib.blake2b(name.encode(), digest_size=8).digest(), "big")
