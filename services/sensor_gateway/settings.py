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
            "where skeletons and images come from. camera: a webcam, URL or video file. marker-camera: a second camera "
            "that is used only to find markers. realsense: a RealSense camera. openni2: a Kinect or other OpenNI 2 "
            "camera. recording: the recording that --path names"
        ),
    )
    path: Path | None = Field(
        None,
        description=(
            "the file that --source recording plays, or a folder whose files it plays in the order of their names"
        ),
    )
    loop: bool = Field(
        False,
        description="repeat the recording or video file endlessly, with a pause of 1 s before each repetition",
    )
    calibration: Path | None = Field(
        None,
        description=(
            "calibration file of the camera, as written by `actum calibrate`; required with --source marker-camera. "
            "Default: for a depth camera, the lens data that the camera reports; for a webcam, a lens computed from "
            "--field-of-view-deg"
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
            "the camera to open: a device number, device path, URL or video file; only with --source camera or "
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
            "the camera's angle of view along the longer side of the image (deg). Used only without --calibration, and "
            "only with --source camera or openni2"
        ),
    )
    mirrored: bool = Field(
        False,
        description=(
            "flip mirrored camera images, so that left and right are correct; only with --source camera or "
            "marker-camera"
        ),
    )
    pose_model: Path = Field(
        default_factory=default_pose_model,
        description=(
            "file of the model that finds people in images; `actum models fetch` downloads this file. --source camera, "
            "realsense and openni2 need it"
        ),
    )
    person_height_m: float | None = Field(
        None,
        gt=0.5,
        lt=2.5,
        description=(
            "body height of the person (m). The height makes the estimated distance from the camera more exact. "
            "Default: an average height"
        ),
    )
    images: bool = Field(
        True,
        description=(
            "publish the camera's images. Use --no-images if a second gateway, with --source marker-camera, publishes "
            "images for this sensor"
        ),
    )
    people: int = Field(2, ge=1, le=4, description="maximum number of people to find in a camera image")
