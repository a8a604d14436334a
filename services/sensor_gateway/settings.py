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

    source: SourceName | None = Field(None, description="the source of the frames")
    path: Path | None = Field(
        None, description="the recording to play: a file, or a folder whose files are played in order"
    )
    loop: bool = Field(False, description="play files again and again, with a pause of a second between two rounds")
    calibration: Path | None = Field(
        None, description="a calibration file of `actum calibrate`, published with each colour image"
    )
    up_in_camera: Direction | None = Field(
        None, description="the upward direction in the frame of a tilted camera, as `actum calibrate up` prints it"
    )
    camera: Annotated[str, BeforeValidator(_text)] = Field(
        "0", description="the camera: a device number or path, a URL, or a video file; only with --source camera"
    )
    camera_size: str | None = Field(
        None,
        pattern=r"^\d{2,5}x\d{2,5}$",
        description="image size to request from the camera, such as 1280x720 (px)",
    )
    field_of_view_deg: float = Field(
        60.0,
        gt=5,
        lt=170,
        description=(
            "angle of view along the longer side of an image, for a camera without calibration; for the sources "
            "camera and openni2 (deg)"
        ),
    )
    mirrored: bool = Field(
        False, description="turn back images that the camera delivers mirrored; only with --source camera"
    )
    pose_model: Path = Field(
        default_factory=default_pose_model,
        description="the pose model file that `actum models fetch` downloads; used with every kind of camera",
    )
    person_height_m: float | None = Field(
        None,
        gt=0.5,
        lt=2.5,
        description="height of the person, from which distances are then estimated; with every kind of camera (m)",
    )
    images: bool = Field(
        True, description="publish images; use --no-images where a marker-camera of the same sensor publishes them"
    )
    people: int = Field(2, ge=1, le=4, description="greatest number of people to find in an image of a camera")
