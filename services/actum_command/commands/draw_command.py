"""`actum draw`: the joints found in a video, drawn into its pictures."""

from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from actum.arrays import Pixels
from actum.messages import Skeleton
from actum.node import SECOND_NS, Counters
from actum_command.commands.terminal import fail, failing_on, refuse_unwritable, say
from actum_command.skeleton_overlay import drawn, sheet
from sensor_gateway.cameras import estimator_of, optics_of
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.video import pictures_of
from sensor_gateway.optics import Optics
from sensor_gateway.perceiver import Perceiver
from sensor_gateway.settings import Settings

COLUMNS = 3  # pictures side by side: two rows for the six that are drawn by default


def draw(
    video: Annotated[Path, typer.Argument(help="the video file in which to find people", exists=True, dir_okay=False)],
    output: Annotated[Path, typer.Option("-o", "--output", help="the image file to write (.png or .jpg)")],
    count: Annotated[
        int,
        typer.Option(
            "--pictures", min=1, max=30, help="number of pictures to draw, taken at even intervals from the video"
        ),
    ] = 6,
    people: Annotated[int, typer.Option(min=1, max=4, help="maximum number of people to find in a picture")] = 2,
) -> None:
    """Find the people in a video and draw their joints, to check a camera before you use it.

    The command writes one image that contains several pictures of the video. In this image, check that people are
    found, and that left and right are not swapped. The camera's settings come from the environment variables
    ACTUM_POSE_MODEL, ACTUM_CALIBRATION (or ACTUM_FIELD_OF_VIEW_DEG) and ACTUM_MIRRORED.
    """
    if not cv2.haveImageWriter(str(output)):
        fail(f"the file name {output} does not end in a known picture format: use .png or .jpg")
    refuse_unwritable(output)
    with failing_on(ValueError, OSError, cv2.error):
        settings = Settings(people=people)
        chosen, frames = joint_pictures(video, settings, optics_of(settings), count)
        output.parent.mkdir(parents=True, exist_ok=True)
        if not cv2.imwrite(str(output), sheet(chosen, COLUMNS)):
            fail(f"the picture {output} cannot be written: give another file")
    say(f"{len(chosen)} of {frames} pictures written to {output}; the actor's left side is blue")


def joint_pictures(video: Path, settings: Settings, optics: Optics, count: int) -> tuple[list[Pixels], int]:
    """Find the joints in every frame of a video as the camera source does, and draw them into `count` of its frames.

    Return the pictures drawn, (height, width, 3) BGR, evenly from the first frame to the last, and how many frames
    there are. The video is decoded once more to count its frames, so that only those drawn are kept in memory.

    Raises:
        ValueError, OSError: the pose model or the video cannot be used.
    """
    with estimator_of(settings) as estimator:
        frames = sum(1 for _ in pictures_of(video))
        chosen = {int(frame) for frame in np.linspace(0, frames - 1, min(count, frames)).round()}
        perceiver = Perceiver(estimator, optics, settings.sensor, video.stem, Counters())
        skeletons = ((picture, perceiver.skeleton(picture)) for picture in pictures_of(video))
        pictures = [_with_joints(*frame, optics) for i, frame in enumerate(skeletons) if i in chosen]
    return pictures, frames


def _with_joints(picture: Picture, skeleton: Skeleton, optics: Optics) -> Pixels:
    """Draw one frame's joints, captioned with its time and how far away each person is."""
    lens = optics.lens_of(picture)
    if lens is None:
        raise ValueError(skeleton.reason)
    depths_m = [np.mean([joint[2] for joint in agent.joints if joint is not None]) for agent in skeleton.agents]
    distances = ", ".join(f"{depth_m:.2f} m" for depth_m in depths_m) or "nobody"
    caption = f"{picture.stamp_ns / SECOND_NS:.2f} s: {distances}"
    return drawn(optics.unmirrored(picture).image_bgr, skeleton.agents, lens, caption)
