"""`actum draw`: the joints found in a video, drawn into its pictures."""

from pathlib import Path
from typing import Annotated

import cv2
import typer

from actum_command.commands.terminal import fail, refuse_unwritable, say
from actum_command.skeleton_overlay import sheet
from actum_command.video_joints import joint_pictures
from sensor_gateway.cameras import optics_of
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
    """Draw the joints of the people found in a video, to check the camera before use.

    The command writes one image that contains several pictures of the video. Check that people are found, and that left
    and right are correct. The camera's settings are read from the environment: ACTUM_POSE_MODEL,
    ACTUM_FIELD_OF_VIEW_DEG or ACTUM_CALIBRATION, ACTUM_MIRRORED.
    """
    if not cv2.haveImageWriter(str(output)):
        fail(f"the file name {output} does not end in a known picture format: use .png or .jpg")
    refuse_unwritable(output)
    try:
        settings = Settings(people=people)
        chosen, frames = joint_pictures(video, settings, optics_of(settings), count)
        output.parent.mkdir(parents=True, exist_ok=True)
        if not cv2.imwrite(str(output), sheet(chosen, COLUMNS)):
            fail(f"the picture {output} cannot be written: give another file")
    except (ValueError, OSError, cv2.error) as error:
        fail(str(error))
    say(f"{len(chosen)} of {frames} pictures written to {output}; the actor's left side is blue")
