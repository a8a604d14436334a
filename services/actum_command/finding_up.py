"""`actum calibrate up`: how a camera is tilted, from a person who stands upright before it."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum.runtime import stop_on_signals
from actum_calibrator.standing import Up, UpFinder
from actum_command.context import connect, fail, say

SILENCE_S = 10.0
POLL_S = 0.01
PAUSE_NS = SECOND_NS // 2
"""How long one wish is left to be read before the next."""


def up(
    recording: Annotated[
        Path | None, typer.Argument(exists=True, dir_okay=False, help="a recording instead of the live stream")
    ] = None,
) -> None:
    """Find how a tilted camera is tilted: one person stands upright and still before it, arms down, for two seconds."""
    frames = _live() if recording is None else _recorded(recording)
    finder, wished, said_ns = UpFinder(), "", -PAUSE_NS
    for frame in frames:
        finder.offer(frame)
        if finder.found is not None:
            _report(finder.found)
            return
        if recording is None and finder.wish != wished and abs(frame.stamp_ns - said_ns) >= PAUSE_NS:
            wished, said_ns = finder.wish, frame.stamp_ns
            say(f"  {wished}")
    fail(f"nobody stood upright and still for long enough: {finder.wish}")


def _report(found: Up) -> None:
    say(
        f"the camera looks {_way(found.pitch_deg, 'up', 'down')} and is turned "
        f"{_way(found.roll_deg, 'clockwise', 'counterclockwise')} (the body swayed by {found.sway_deg:.1f} degrees)"
    )
    numbers = ", ".join(f"{component:.3f}" for component in found.in_camera)
    say(f"tell its sensor gateway: ACTUM_UP_IN_CAMERA='[{numbers}]'")


def _way(angle_deg: float, positive: str, negative: str) -> str:
    return f"{positive if angle_deg >= 0 else negative} by {abs(angle_deg):.1f} degrees"


def _recorded(path: Path) -> Iterator[Skeleton]:
    try:
        for message in Recording(path).messages((keys.SKELETON,)):
            if isinstance(message, Skeleton):
                yield message
    except RecordingError as error:
        fail(str(error))


def _live() -> Iterator[Skeleton]:
    """Yield skeletons as they come, until Ctrl-C."""
    stop = stop_on_signals()
    with connect() as client:
        key = keys.key(keys.SKELETON, client.sensor)
        stream, heard_s = client.listen(key), time.monotonic()
        say(f"watching {key}; Ctrl-C ends")
        while not stop.wait(POLL_S):
            while (received := stream.take()) is not None:
                heard_s = time.monotonic()
                if isinstance(received.message, Skeleton):
                    yield received.message
            if time.monotonic() - heard_s > SILENCE_S:
                fail(f"no skeleton on {key} for {SILENCE_S:g} s: does its gateway run?")
