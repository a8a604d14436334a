"""The windows that heads are trained on: of whole actions, of parts of them, across their bounds, and of background."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Detection
from actum_model_trainer.samples import LabelledStream
from som_classifier.kinematics import GAP_NS
from som_classifier.spotting.pyramid_spotter import COVERED_SHARE as LIVE_COVERED_SHARE
from som_classifier.spotting.pyramid_spotter import FEWEST_FRAMES
from som_classifier.spotting.spotting_model import completeness_of_iou

JITTERED = 3
"""Windows of each action with both bounds moved a little: no search finds bounds exactly."""
JITTER = 0.15
"""By up to how much of the duration these bounds are moved."""
BEGINNINGS = 3
"""Windows of each action that hold its beginning only: what a live search sees before the end."""
ENDS = 2
"""Windows of each action that hold its end only."""
TOO_LONG = 3
"""Windows of each action that begin before it or end after it."""
STRADDLING = 3
"""Windows of each action that begin within or shortly before it, of any usual duration."""
LEAST_PART = 0.25
"""Smallest share of an action in a window that holds a part of it."""
LARGEST_PART = 0.9
"""Largest such share."""
BACKGROUND = 2
"""Windows anywhere in the stream, for each action in it and at least for each five seconds."""
BACKGROUND_S = 5.0
"""See `BACKGROUND`: streams without any action count, too."""
FALSE_ALARM = 6
"""Windows about each false alarm, bounds moved a little: as many as hold half or more of an action."""
COVERED_SHARE = 0.6
"""Share of a window over which there must be frames."""
Stamps = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class TrainingWindows:
    """Windows of one stream.

    Attributes:
        frames: (n, 2), first and last frame of each.
        completeness: (n, actions), what the heads are to answer.
    """

    frames: Indices
    completeness: Array


def training_windows(
    stream: LabelledStream, labels: Sequence[str], durations_s: Array, rng: np.random.Generator
) -> TrainingWindows:
    """Draw the windows of a stream.

    Args:
        stream: with its labelled segments.
        labels: the actions.
        durations_s: of the live search's windows.
        rng: draws.
    """
    spans_ns: Array = np.array([*_spans(stream, durations_s * SECOND_NS, rng)], np.float64).reshape(-1, 2)
    frames = _frames_within(stream.stamps_ns, spans_ns)
    enough = np.diff(frames)[:, 0] + 1 >= FEWEST_FRAMES
    covered_ns = np.diff(stream.stamps_ns[frames[enough]])
    windows = frames[enough][(covered_ns >= COVERED_SHARE * np.diff(spans_ns[enough]))[:, 0]]
    return TrainingWindows(windows, true_completeness(stream, windows, labels))


def with_false_alarms(
    stream: LabelledStream, windows: TrainingWindows, alarms: Sequence[Detection], rng: np.random.Generator
) -> TrainingWindows:
    """Add windows about each false alarm in a stream, which hold none of the actions."""
    bounds_ns = np.array([(alarm.start_ns, alarm.end_ns) for alarm in alarms]).reshape(-1, 1, 2)
    shifts = rng.uniform(-JITTER, JITTER, (len(alarms), FALSE_ALARM, 2))
    frames = _frames_within(stream.stamps_ns, (bounds_ns + shifts * np.diff(bounds_ns)).reshape(-1, 2))
    added = frames[np.diff(frames)[:, 0] + 1 >= FEWEST_FRAMES]
    none = np.zeros((len(added), windows.completeness.shape[1]))
    return TrainingWindows(np.concatenate([windows.frames, added]), np.concatenate([windows.completeness, none]))


def true_completeness(stream: LabelledStream, frames: Indices, labels: Sequence[str]) -> Array:
    """Return how complete each action is at most within windows of these frames (n, 2), shape (n, actions)."""
    starts_ns, ends_ns = stream.stamps_ns[frames[:, 0]], stream.stamps_ns[frames[:, 1]]
    completeness = np.zeros((len(frames), len(labels)))
    by_end, longest_ns = np.argsort(ends_ns, kind="stable"), int((ends_ns - starts_ns).max(initial=0))
    for start_ns, end_ns, label in stream.segments:
        if label in labels:
            bounds = np.searchsorted(ends_ns, (start_ns, end_ns + longest_ns), sorter=by_end)
            near = by_end[slice(*bounds.tolist())]  # no other window overlaps the segment
            iou = overlap_ratio(starts_ns[near], ends_ns[near], start_ns, end_ns)
            column = completeness[:, labels.index(label)]
            column[near] = np.maximum(column[near], completeness_of_iou(iou))
    return completeness


def live_windows(stamps_ns: Stamps, durations_ns: Stamps, interval_ns: int) -> Indices:
    """Return first and last frame of all windows that a live search looks at, in order, shape (windows, 2).

    Args:
        stamps_ns: (n,), rising, of the stream's frames.
        durations_ns: of the windows, rising.
        interval_ns: between two decisions.
    """
    gaps = np.flatnonzero(np.diff(stamps_ns) > GAP_NS) + 1
    run_starts = np.zeros(len(stamps_ns), dtype=np.intp)
    run_starts[gaps] = gaps
    run_starts = np.maximum.accumulate(run_starts)
    lasts, next_ns = [], 0
    for last, (now_ns, run_start) in enumerate(zip(stamps_ns.tolist(), run_starts.tolist(), strict=True)):
        if now_ns >= next_ns or run_start == last:
            next_ns = now_ns + interval_ns
            lasts.append(last)
    ends = np.array(lasts, dtype=np.intp)[:, None]
    firsts = np.searchsorted(stamps_ns, stamps_ns[ends] - durations_ns)
    firsts = np.maximum(firsts, run_starts[ends])
    covered = stamps_ns[ends] - stamps_ns[firsts] >= LIVE_COVERED_SHARE * durations_ns
    usable = covered & (ends - firsts + 1 >= FEWEST_FRAMES)
    return np.stack([firsts[usable], np.broadcast_to(ends, firsts.shape)[usable]], axis=1)


def overlap_ratio(starts_ns: Stamps, ends_ns: Stamps, start_ns: int, end_ns: int) -> Array:
    """Return the intersection over union of spans (n,) with one span, shape (n,)."""
    common = np.maximum(np.minimum(ends_ns, end_ns) - np.maximum(starts_ns, start_ns), 0)
    union = np.maximum(ends_ns, end_ns) - np.minimum(starts_ns, start_ns)
    ratio: Array = common / np.maximum(union, 1)
    return ratio


def _spans(stream: LabelledStream, durations_ns: Array, rng: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Yield start and end (ns) of the windows to be drawn; some lie where there are no frames."""
    first_ns, last_ns = int(stream.stamps_ns[0]), int(stream.stamps_ns[-1])
    segments = stream.segments
    for start_ns, end_ns, _ in segments:
        yield start_ns, end_ns
        yield from _about(start_ns, end_ns, durations_ns, rng)
    stretches = min(
        int((last_ns - first_ns) / SECOND_NS / BACKGROUND_S), len(stream.stamps_ns)
    )  # one stamp may be wrong
    anywhere = BACKGROUND * max(len(segments), stretches)
    for duration_ns in rng.choice(durations_ns, anywhere):
        start_ns = rng.uniform(first_ns, max(last_ns - duration_ns, first_ns + 1))
        yield start_ns, start_ns + duration_ns


def _about(start_ns: int, end_ns: int, durations_ns: Array, rng: np.random.Generator) -> Iterator[tuple[float, float]]:
    duration_ns = end_ns - start_ns
    for shift_start, shift_end in rng.uniform(-JITTER, JITTER, (JITTERED, 2)) * duration_ns:
        yield start_ns + shift_start, end_ns + shift_end
    for part in rng.uniform(LEAST_PART, LARGEST_PART, BEGINNINGS) * duration_ns:
        yield start_ns, start_ns + part
    for part in rng.uniform(LEAST_PART, LARGEST_PART, ENDS) * duration_ns:
        yield end_ns - part, end_ns
    for excess, before in zip(rng.uniform(0.1, 1.0, TOO_LONG) * duration_ns, rng.random(TOO_LONG) < 0.5, strict=True):
        yield (start_ns - excess, end_ns) if before else (start_ns, end_ns + excess)
    shifts = rng.uniform(-LARGEST_PART, LARGEST_PART, STRADDLING) * duration_ns
    for shift, length in zip(shifts, rng.choice(durations_ns, STRADDLING), strict=True):
        yield start_ns + shift, start_ns + shift + length


def _frames_within(stamps_ns: Stamps, spans_ns: Array) -> Indices:
    """Return first and last frame of spans (n, 2), in the same shape; the last is before the first in an empty one."""
    firsts = np.searchsorted(stamps_ns, spans_ns[:, 0])
    afters = np.searchsorted(stamps_ns, spans_ns[:, 1], side="right")
    return np.stack([firsts, afters - 1], axis=1)
