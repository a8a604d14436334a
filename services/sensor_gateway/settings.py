"""Settings of the sensor gateway."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from actum.messages import Direction
from actum.settings import ServiceSettings, data_folder

SourceName = Literal["camera", "marker-camera", "realsense", "openni2", "recording"]


POSE_MODEL = "pose_landmarker_full.task"


def default_pose_model() -> Path:
    """Return the path at which `actum models fetch` stores the pose model, in the user's data folder."""
    return data_folder() / POSE_MODEL


def _text(number: object) -> object:
    return str(number) if type(number) is int else number


class Settings(ServiceSettings):
    """The gateway's settings, beside those of every service."""

    source: SourceName | None = Field(
        None,
        description=(
            "where skeletons and images come from: camera (webcam, URL or video file); marker-camera (a second camera "
            "used only for markers, not for skeletons); realsense; openni2 (Kinect); recording (the files in --path)"
        ),
    )
    path: Path | None = Field(
        None,
        description=(
            "the recording to play with --source recording: a file, or a folder whose files are played in the order of "
            "their names"
        ),
    )
    loop: bool = Field(
        False,
        description="play the recording or video file again and again, with a pause of 1 s before each repetition",
    )
    calibration: Path | None = Field(
        None,
        description=(
            "calibration file of the camera, as written by `actum calibrate`; required with --source marker-camera. "
            "Default: the lens data that a depth camera reports; for a webcam, a lens computed from --field-of-view-deg"
        ),
    )
    up_in_camera: Direction | None = Field(
        None,
        description=(
            "the upward direction as x,y,z in the coordinates of a tilted camera; `actum calibrate up` prints this "
            "value. Default: the camera is assumed to be level"
        ),
    )
    camera: Annotated[str, BeforeValidator(_text)] = Field(
        "0",
        description=(
            "the camera to open: a device number or path, a URL, or a video file; only for --source camera and "
            "marker-camera"
        ),
    )
    camera_size: str | None = Field(
        None,
        pattern=r"^\d{2,5}x\d{2,5}$",
        description=(
            "width and height in pixels to request from the camera, such as 1280x720; default: 640x480 with --source "
            "realsense or openni2, otherwise the camera's own choice"
        ),
    )
    field_of_view_deg: float = Field(
        60.0,
        gt=5,
        lt=170,
        description=(
            "the camera's angle of view along the longer side of the image (deg); used only with --source camera or "
            "openni2, and only if --calibration is not set"
        ),
    )
    mirrored: bool = Field(
        False,
        description=(
            "set this if the camera delivers mirrored images, so that left and right are corrected; only with --source "
            "camera or marker-camera"
        ),
    )
    pose_model: Path = Field(
        default_factory=default_pose_model,
        description=(
            "file of the model that finds people in images, as downloaded by `actum models fetch`; needed with "
            "--source camera, realsense and openni2"
        ),
    )
    person_height_m: float | None = Field(
        None,
        gt=0.5,
        lt=2.5,
        description=(
            "body height of the person (m), which makes estimated distances from the camera more exact; default: an "
            "average height is assumed"
        ),
    )
    images: bool = Field(
        True,
        description=(
            "publish the camera's images; use --no-images if a second process with --source marker-camera publishes "
            "images for this sensor"
        ),
    )
    people: int = Field(2, ge=1, le=4, description="maximum number of people to find in a camera image")
