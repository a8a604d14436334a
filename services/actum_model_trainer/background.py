"""Background: movement that nobody taught, which training holds against what was taught.

The file that comes with actum holds simulated people's streams as whole millimetres, thinned out: half an hour in 3 MB.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from actum.arrays import Array
from actum.atomic_file import replaced
from actum.messages import NONE
from actum.node import SECOND_NS
from actum_model_trainer.samples import LabelledStream, SegmentSample

SHIPPED = Path(__file__).with_name("background.npz")
"""The file that comes with actum; `make background` writes it."""
STEP = 2
"""Every second frame is kept of 30 a second; no sensor that is supported is slower."""
PER_M = 1000
"""Whole steps per metre: a tracker's noise is several millimetres."""
LOG_DURATION_SD = 0.5
"""Spread of ln(duration / s) of the windows about the taught actions' mean: people's tempos differ by less."""
FEWEST_FRAMES = 8
"""Frames of a window: half a second of most sensors."""
LEAST_SPEED_M_S = 0.25
"""Mean of the five body parts' summed speed in a window: stillness is judged otherwise."""
DRAWS_PER_WINDOW = 20
"""Windows that are looked at for each that is wanted, where people stand or are out of sight most of the time."""
ARRAYS = ("motion", "postures", "velocities")


def save(streams: Sequence[LabelledStream], path: Path) -> None:
    """Write people's streams, every `STEP`th frame, without their labels."""
    arrays = {
        "motion": [np.add.reduceat(stream.motion, np.arange(0, len(stream.motion), STEP)) for stream in streams],
        "postures": [stream.postures[::STEP] for stream in streams],
        "velocities": [stream.velocities[::STEP] for stream in streams],
    }
    whole = {name: np.rint(PER_M * np.concatenate(of_streams)).astype(np.int16) for name, of_streams in arrays.items()}
    stamps_ns = [stream.stamps_ns[::STEP] for stream in streams]
    with replaced(path) as file:
        np.savez_compressed(
            file, frames=list(map(len, stamps_ns)), stamps_ns=np.concatenate(stamps_ns), allow_pickle=False, **whole
        )


@cache
def shipped() -> tuple[LabelledStream, ...]:
    """Return the streams of the background that comes with actum."""
    with np.load(SHIPPED) as stored:
        ends = np.cumsum(stored["frames"])[:-1]
        stamps_ns = np.split(stored["stamps_ns"], ends)
        arrays = [np.split(stored[name] / PER_M, ends) for name in ARRAYS]
    return tuple(
        LabelledStream(stamps, motion, postures, velocities, (), f"background {number}", str(SHIPPED), number)
        for number, (stamps, motion, postures, velocities) in enumerate(zip(stamps_ns, *arrays, strict=True))
    )


def counterexamples(streams: Sequence[LabelledStream]) -> list[LabelledStream]:
    """Cut out of streams what is labelled as none of the actions, each a stream of its own."""
    return [_clip(stream, each) for stream in streams for each in stream.segments if each[2] == NONE]


def _clip(stream: LabelledStream, segment: tuple[int, int, str]) -> LabelledStream:
    part = slice(*np.searchsorted(stream.stamps_ns, (segment[0], segment[1] + 1)).tolist())
    arrays = {name: getattr(stream, name)[part] for name in ("stamps_ns", *ARRAYS)}
    return replace(stream, segments=(segment,), **arrays)


def negatives_of(
    streams: Sequence[LabelledStream], durations_s: Array, count: int, rng: np.random.Generator
) -> list[SegmentSample]:
    """Return the counterexamples of streams, labelled so, and windows that are drawn where there is more than these."""
    others = [stream for stream in streams if not stream.is_counterexample]
    clips = [each for each in counterexamples(streams) if len(each.stamps_ns) >= FEWEST_FRAMES]
    cut = [replace(_cut(clip, 0, len(clip.stamps_ns)), label=NONE) for clip in clips]
    return [*cut, *windows_of(others, durations_s, count, rng)]


def windows_of(
    streams: Sequence[LabelledStream], durations_s: Array, count: int, rng: np.random.Generator
) -> list[SegmentSample]:
    """Draw windows in which somebody moves, about as long as the actions that were taught; fewer where there are few.

    Args:
        streams: the background; labelled segments in it count as background, too.
        durations_s: of the taught actions.
        count: how many windows.
        rng: draws them.
    """
    usable = [stream for stream in streams if len(stream.stamps_ns) >= FEWEST_FRAMES]
    found: list[SegmentSample] = []
    usual = float(np.log(durations_s).mean())
    for _ in range(DRAWS_PER_WINDOW * count if usable else 0):
        stream = usable[rng.integers(len(usable))]
        first = int(rng.integers(len(stream.stamps_ns)))
        end_ns = stream.stamps_ns[first] + SECOND_NS * np.exp(rng.normal(usual, LOG_DURATION_SD))
        last = int(np.searchsorted(stream.stamps_ns, end_ns))
        least_m = LEAST_SPEED_M_S * (end_ns - stream.stamps_ns[first]) / SECOND_NS
        moves = np.nansum(stream.motion[first:last]) >= least_m
        if last < len(stream.stamps_ns) and last - first >= FEWEST_FRAMES and moves:
            found.append(_cut(stream, first, last))
        if len(found) == count:
            break
    return found


def _cut(stream: LabelledStream, first: int, last: int) -> SegmentSample:
    return SegmentSample(
        "",
        stream.stamps_ns[first:last],
        stream.postures[first:last],
        stream.motion[first:last],
        stream.postures[first:last],
        stream.velocities[first:last],
        stream.person,
        stream.file,
        "",
        stream.depth_inferred,
    )
