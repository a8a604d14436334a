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
            "where skeletons and images come from: camera (webcam, URL or video file); marker-camera (a second "
            "camera, for markers only); realsense; openni2 (Kinect); recording (the files in --path)"
        ),
    )
    path: Path | None = Field(
        None,
        description="the recording to play with --source recording: a file, or a folder of files, played in order",
    )
    loop: bool = Field(False, description="play the files again and again, with a pause of 1 s between two rounds")
    calibration: Path | None = Field(
        None,
        description=(
            "the camera's calibration file, which `actum calibrate` wrote; default: the device's own lens data, or "
            "--field-of-view-deg"
        ),
    )
    up_in_camera: Direction | None = Field(
        None,
        description=(
            "the upward direction as x,y,z in the coordinates of a tilted camera; `actum calibrate up` prints it. "
            "Default: the camera is level"
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
        description="image size to request from the camera, such as 1280x720; default: the camera's own choice (px)",
    )
    field_of_view_deg: float = Field(
        60.0,
        gt=5,
        lt=170,
        description=(
            "angle of view along the longer side of the image; used only without --calibration, with --source "
            "camera or openni2 (deg)"
        ),
    )
    mirrored: bool = Field(
        False,
        description=(
            "set this if the camera delivers mirrored images, so that left and right are corrected; only with "
            "--source camera"
        ),
    )
    pose_model: Path = Field(
        default_factory=default_pose_model,
        description=(
            "the model that finds people in images, as downloaded by `actum models fetch`; needed with every source "
            "that is a camera"
        ),
    )
    person_height_m: float | None = Field(
        None,
        gt=0.5,
        lt=2.5,
        description=(
            "body height of the person, which makes estimated distances more exact; default: an average height is "
            "assumed (m)"
        ),
    )
    images: bool = Field(
        True,
        description=(
            "publish images; use --no-images if a second process with --source marker-camera publishes them for "
            "this sensor"
        ),
    )
    people: int = Field(2, ge=1, le=4, description="maximum number of people to find in a camera image")
