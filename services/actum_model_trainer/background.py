"""Movement that nobody taught, which training holds against what was taught: the background that comes with actum.

Its file holds simulated people's streams as whole millimetres, thinned out: half an hour in a few MB.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from actum.atomic_file import replaced
from actum_model_trainer.samples import LabelledStream

SHIPPED = Path(__file__).with_name("background.npz")
"""The file that comes with actum; `make background` writes it."""
STEP = 2
"""Every second frame is kept of 30 a second; no sensor that is supported is slower."""
PER_M = 1000
"""Whole steps per metre: a tracker's noise is several millimetres."""
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
        np.savez_compressed(file, frames=list(map(len, stamps_ns)), stamps_ns=np.concatenate(stamps_ns), **whole)


@cache
def shipped() -> tuple[LabelledStream, ...]:
    """Return the streams of the background that comes with actum."""
    with np.load(SHIPPED) as stored:
        ends = np.cumsum(stored["frames"])[:-1]
        stamps_ns = np.split(stored["stamps_ns"], ends)
        arrays = [np.split(stored[name] / PER_M, ends) for name in ARRAYS]
    return tuple(
        LabelledStream(stamps, *of_stream, (), f"background {number}", str(SHIPPED), number)
        for number, (stamps, *of_stream) in enumerate(zip(stamps_ns, *arrays, strict=True))
    )
