"""Windows of several durations over a stream, and those that a classifier of windows is trained on."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Truth

from .streams import Stream

Indices = NDArray[np.intp]

DURATIONS = 8
QUANTILES = (0.04, 0.96)
"""The windows' durations are even quantiles of those of the training's truths, between these two."""
STEP_S = 0.1
"""A window of each duration ends at least so often: three frames at 30 Hz."""
EARLY_NS = SECOND_NS // 200
"""A frame so little before a step is due (ns) ends a window: stamps jitter by milliseconds."""
FEWEST_FRAMES = 4
COVERED = 0.8
"""The share of its duration that a window's frames reach over at least."""
NONE = "(none)"
BACKGROUND_PER_TRUTH = 2
LITTLE_COVERED = 0.15
"""Half of the background is covered by truths by less than this share."""
NO_TRUTH_IOU, STILL_TRUE_IOU = 0.5, 0.7
"""A window of background overlaps every truth less; one that is jittered overlaps its truth at least as much."""
TRIES = 200
"""Draws after which a window of a kind is given up: short streams hold none."""


@dataclass(frozen=True)
class Window:
    """Frames of a stream, both inclusive, and what they show."""

    stream: Stream
    first: int
    last: int
    label: str


def durations_s(streams: Sequence[Stream]) -> NDArray[np.float64]:
    """Return the windows' durations (DURATIONS,) in seconds."""
    lengths_s = [(truth.end_ns - truth.start_ns) / SECOND_NS for stream in streams for truth in stream.truths]
    return np.asarray(np.quantile(lengths_s, np.linspace(*QUANTILES, DURATIONS)), dtype=np.float64)


def sliding(stream: Stream, lengths_s: NDArray[np.float64]) -> tuple[Indices, Indices]:
    """Return the ends (steps,) and the starts (steps, durations) of all windows, as frames; −1 where there is none."""
    stamps_ns = stream.stamps_ns
    ends = _ends(stamps_ns)
    lengths_ns = lengths_s * SECOND_NS
    starts = np.searchsorted(stamps_ns, stamps_ns[ends][:, None] - lengths_ns).astype(np.intp)
    reached = stamps_ns[ends][:, None] - stamps_ns[starts] >= COVERED * lengths_ns
    enough = ends[:, None] - starts + 1 >= FEWEST_FRAMES
    return ends, np.where(reached & enough, starts, -1)


def _ends(stamps_ns: NDArray[np.int64]) -> Indices:
    """Return the frames (steps,) that are at least a step apart."""
    ends, next_ns = [], int(stamps_ns[0])
    for i, stamp_ns in enumerate(stamps_ns.tolist()):
        if stamp_ns >= next_ns - EARLY_NS:
            ends.append(i)
            next_ns = stamp_ns + round(STEP_S * SECOND_NS)
    return np.array(ends, dtype=np.intp)


def training_windows(streams: Sequence[Stream], rng: np.random.Generator) -> list[Window]:
    """Return each truth, a jittered one beside it, and background."""
    true = [window for stream in streams for truth in stream.truths for window in _true(stream, truth)]
    jittered = [window for each in true if (window := _jittered(each, rng))]
    return [*true, *jittered, *_background(streams, true, rng)]


def overlap_share(stream: Stream, first: int, last: int) -> tuple[float, float]:
    """Return the largest IoU of some frames with a truth, and the share of them that truths cover."""
    start_ns, end_ns = int(stream.stamps_ns[first]), int(stream.stamps_ns[last])
    largest, covered_ns = 0.0, 0
    for truth in stream.truths:
        common_ns = min(end_ns, truth.end_ns) - max(start_ns, truth.start_ns)
        if common_ns > 0:
            largest = max(largest, common_ns / (max(end_ns, truth.end_ns) - min(start_ns, truth.start_ns)))
            covered_ns += common_ns
    return largest, min(1.0, covered_ns / max(1, end_ns - start_ns))


def _true(stream: Stream, truth: Truth) -> Iterator[Window]:
    first, last = stream.frames_of(truth)
    if last - first + 1 >= FEWEST_FRAMES:
        yield Window(stream, first, last, truth.label)


def _jittered(window: Window, rng: np.random.Generator) -> Window | None:
    frames = window.last - window.first + 1
    for _ in range(TRIES):
        first = window.first + round(rng.uniform(-0.3, 0.3) * frames)
        last = window.last + round(rng.uniform(-0.3, 0.3) * frames)
        if first < 0 or last >= len(window.stream.stamps_ns) or last - first + 1 < FEWEST_FRAMES:
            continue
        common = min(last, window.last) - max(first, window.first) + 1
        if common / (max(last, window.last) - min(first, window.first) + 1) >= STILL_TRUE_IOU:
            return Window(window.stream, first, last, window.label)
    return None


def _background(streams: Sequence[Stream], true: Sequence[Window], rng: np.random.Generator) -> Iterator[Window]:
    weights = np.array([len(stream.stamps_ns) for stream in streams], dtype=float)
    lengths = [window.last - window.first for window in true]
    for number in range(BACKGROUND_PER_TRUTH * len(true)):
        for _ in range(TRIES):
            stream = streams[rng.choice(len(streams), p=weights / weights.sum())]
            length = lengths[rng.integers(len(lengths))]
            if length >= len(stream.stamps_ns):
                continue
            first = int(rng.integers(len(stream.stamps_ns) - length))
            iou, covered = overlap_share(stream, first, first + length)
            if iou < NO_TRUTH_IOU and (number % 2 or covered < LITTLE_COVERED):
                yield Window(stream, first, first + length, NONE)
                break
