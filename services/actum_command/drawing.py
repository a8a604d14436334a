"""`actum draw`: the joints found in a video, drawn into its pictures."""

from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from actum.messages import Skeleton
from actum.node import SECOND_NS, Counters
from actum_command.context import fail, refuse_unwritable, say
from actum_command.skeleton_overlay import Pixels, drawn, sheet
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.video import pictures_of
from sensor_gateway.optics import Optics
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings

COLUMNS = 3


def draw_command(
    video: Annotated[Path, typer.Argument(help="a video file", exists=True, dir_okay=False)],
    output: Annotated[Path, typer.Option("-o", "--output", help="the image to write, .png or .jpg")],
    count: Annotated[int, typer.Option("--pictures", min=1, max=30, help="how many, evenly over the video")] = 6,
    people: Annotated[int, typer.Option(min=1, max=4, help="how many people are looked for")] = 2,
) -> None:
    """Draw the fifteen joints of everybody in a video: is the person found, is left their left, does the lens fit?

    The camera is described as for the gateway: ACTUM_POSE_MODEL, ACTUM_FIELD_OF_VIEW_DEG or ACTUM_CALIBRATION,
    ACTUM_MIRRORED.
    """
    if not cv2.haveImageWriter(str(output)):
        fail(f"{output}: no kind of picture that can be written; name a .png or .jpg")
    refuse_unwritable(output)
    try:
        settings = Settings(people=people)
        chosen, frames = _drawn(video, settings, optics_of(settings), count)
        output.parent.mkdir(parents=True, exist_ok=True)
        if not cv2.imwrite(str(output), sheet(chosen, COLUMNS)):
            fail(f"{output} cannot be written")
    except (ValueError, OSError, cv2.error) as error:
        fail(str(error))
    say(f"{len(chosen)} of {frames} pictures, the actor's left blue: {output}")


def _evenly(count: int, frames: int) -> set[int]:
    """Choose so many frames of a video, from its first to its last; all where it has fewer."""
    return {int(frame) for frame in np.linspace(0, frames - 1, min(count, frames)).round()}


def _drawn(video: Path, settings: Settings, optics: Optics, count: int) -> tuple[list[Pixels], int]:
    """See a video as the camera source does, every frame of it, and draw so many; return them, and how many it has.

    It is decoded once to count its frames, so that only those are kept which are drawn.
    """
    with estimator_of(settings) as estimator:
        frames = sum(1 for _ in pictures_of(video))
        chosen = _evenly(count, frames)
        perceiver = Perceiver(estimator, optics, settings.sensor, video.stem, Counters())
        seen = ((picture, perceiver.skeleton(picture)) for picture in pictures_of(video))
        pictures = [_with_joints(*frame, optics) for i, frame in enumerate(seen) if i in chosen]
    return pictures, frames


def _with_joints(picture: Picture, skeleton: Skeleton, optics: Optics) -> Pixels:
    lens = optics.lens_of(picture)
    if lens is None:
        raise ValueError(skeleton.reason)
    distances = ", ".join(f"{_distance_m(agent.joints):.2f} m" for agent in skeleton.agents) or "nobody"
    return drawn(
        optics.seen(picture).image_bgr, skeleton.agents, lens, f"{picture.stamp_ns / SECOND_NS:.2f} s: {distances}"
    )


def _distance_m(joints: list[list[float] | None]) -> float:
    return float(np.mean([joint[2] for joint in joints if joint is not None]))
