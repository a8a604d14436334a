"""`actum calibrate up`: how a camera is tilted, from a person who stands upright before it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording, RecordingError
from actum.runtime import stop_on_signals
from actum_calibrator.up_direction import UpDirectionEstimator
from actum_command.commands.terminal import connect, fail, failing_on, say
from actum_command.live_calibration import SilentStreamError, live_skeletons

PAUSE_NS = SECOND_NS // 2  # shortest time between two instructions, so that each can be read


def up(
    recording: Annotated[
        Path | None,
        typer.Argument(
            exists=True,
            dir_okay=False,
            help=(
                "a recording of a person who stands upright and still. Default: measure with the person whom the "
                "running camera sees"
            ),
        ),
    ] = None,
) -> None:
    """Measure the tilt of a camera with the help of a person.

    The person has to stand upright and still in front of the camera for two seconds, with the arms hanging down. The
    command prints the environment variable ACTUM_UP_IN_CAMERA with its value; set this variable for the sensor gateway.
    """
    frames = _live() if recording is None else _recorded(recording)
    estimator, instruction, instructed_ns = UpDirectionEstimator(), "", -PAUSE_NS
    for frame in frames:
        estimator.offer(frame)
        if estimator.up is not None:
            break
        is_new = estimator.instruction != instruction and abs(frame.stamp_ns - instructed_ns) >= PAUSE_NS
        if recording is None and is_new:
            instruction, instructed_ns = estimator.instruction, frame.stamp_ns
            say(f"  {instruction}")
    if (tilt := estimator.up) is None:
        fail(
            "nobody stood upright and still for two seconds: try again, and follow the instructions. The last one was "
            f"'{estimator.instruction}'"
        )
    say(
        f"the camera looks {_signed(tilt.pitch_deg, 'up', 'down')} and is turned "
        f"{_signed(tilt.roll_deg, 'clockwise', 'counterclockwise')} (the body swayed by {tilt.sway_deg:.1f} degrees)"
    )
    numbers = ", ".join(f"{component:.3f}" for component in tilt.in_camera)
    say(f"set this for the camera's sensor gateway: ACTUM_UP_IN_CAMERA='[{numbers}]'")


def _signed(angle_deg: float, positive: str, negative: str) -> str:
    """Return an angle in words, its sign as one of two words."""
    return f"{positive if angle_deg >= 0 else negative} by {abs(angle_deg):.1f} degrees"


def _recorded(path: Path) -> Iterator[Skeleton]:
    with failing_on(RecordingError):
        for message in Recording(path).messages((keys.SKELETON,)):
            if isinstance(message, Skeleton):
                yield message


def _live() -> Iterator[Skeleton]:
    stop = stop_on_signals()
    with connect() as client, failing_on(SilentStreamError):
        yield from live_skeletons(client, stop, say)
